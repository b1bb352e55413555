// SPDX-License-Identifier: MIT
/// Records in memory as an input: attributes of every type, or the output of another run.
#pragma once

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {

/// A reader of whole records of any schema.
class RecordReader final : public Reader {
 public:
  RecordReader(Schema schema, std::vector<std::byte> records) : records_(std::move(records)) {
    info_.schema = std::move(schema);
    info_.count = records_.size() / info_.schema.stride;
    info_.path = "records in memory";
    info_.format = "memory";
  }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t stride = info_.schema.stride, from = std::min<std::size_t>(row * stride, records_.size());
    const std::size_t bytes = std::min(records.size() / stride * stride, records_.size() - from);
    if (bytes > 0) std::memcpy(records.data(), records_.data() + from, bytes);
    return bytes / stride;
  }

 private:
  std::vector<std::byte> records_;
};

struct Records {
  Schema schema;
  std::vector<std::byte> bytes;

  std::size_t size() const { return bytes.size() / schema.stride; }
  const std::byte* at(std::size_t row) const { return bytes.data() + row * schema.stride; }
  double value(std::size_t row, const std::string& field) const {
    return value_of(schema.fields[*schema.find(field)], at(row));
  }
  Vec3 position(std::size_t row) const { return {value(row, "x"), value(row, "y"), value(row, "z")}; }
  std::vector<Vec3> positions() const {
    std::vector<Vec3> all;
    for (std::size_t i = 0; i < size(); ++i) all.push_back(position(i));
    return all;
  }
  /// Returns the records of the rows for which keep(row) is true.
  template <class Keep>
  Records those(Keep keep) const {
    Records out{schema, {}};
    for (std::size_t i = 0; i < size(); ++i)
      if (keep(i)) out.bytes.insert(out.bytes.end(), at(i), at(i) + schema.stride);
    return out;
  }
  Records kept(const std::vector<bool>& keep) const {
    return those([&](std::size_t i) { return keep[i]; });
  }
  InputCloud cloud() const {
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::make_unique<RecordReader>(schema, bytes));
    return InputCloud(std::move(readers));
  }
};

inline RunResult run_text(const Records& input, const std::string& pipeline, const EngineOptions& options,
                          const std::vector<std::string>& keep = {}) {
  InputCloud cloud = input.cloud();
  return run_in_memory(cloud, build_chain(parse_pipeline(pipeline), cloud, keep), options);
}

inline Records records_of(const RunResult& result) { return {result.schema, result.records}; }

/// Returns `points` as records of x, y, z f64, classification u8 (0 to 9), intensity u16, gain f32 (a tenth NaN) and id
/// u64 (2^63 + row).
inline Records with_attributes(const std::vector<Vec3>& points, std::uint64_t seed = 5) {
  Records out;
  for (const char* axis : {"x", "y", "z"}) out.schema.append(axis, Type::f64);
  out.schema.append("classification", Type::u8);
  out.schema.append("intensity", Type::u16);
  out.schema.append("gain", Type::f32);
  out.schema.append("id", Type::u64);
  std::mt19937_64 random(seed);
  out.bytes.resize(points.size() * out.schema.stride);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::byte* record = out.bytes.data() + i * out.schema.stride;
    auto put = [&, at = std::size_t{0}](auto value) mutable {
      std::memcpy(record + at, &value, sizeof value);
      at += sizeof value;
    };
    put(points[i]);
    put(static_cast<std::uint8_t>(random() % 10));
    put(static_cast<std::uint16_t>(random()));
    const bool none = random() % 10 == 0;
    put(none ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(random() % 1000) / 1000);
    put((std::uint64_t{1} << 63) + i);
  }
  return out;
}

}  // namespace pointsweep
