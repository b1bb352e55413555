// SPDX-License-Identifier: MIT
/// Functions that tests of formats share: whole files as bytes and values.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Returns all records, read `block` records at a time.
template <class Source>
std::vector<std::byte> all_records(Source& source, const Schema& schema, std::uint64_t count,
                                   std::size_t block = 1000) {
  std::vector<std::byte> records(count * schema.stride);
  for (std::uint64_t row = 0; row < count;) {
    const std::size_t rows = source.read(row, std::span(records)
                                                  .subspan(row * schema.stride)
                                                  .first(std::min<std::uint64_t>(block, count - row) * schema.stride));
    if (rows == 0) throw std::runtime_error("read() gave nothing before the end");
    row += rows;
  }
  return records;
}

inline std::vector<std::byte> all_records(Reader& reader, std::size_t block = 1000) {
  return all_records(reader, reader.info().schema, reader.info().count, block);
}

/// Returns the bytes of all records, read at once.
inline std::string record_text(Reader& reader) {
  std::string bytes(reader.info().count * reader.info().schema.stride, '\0');
  EXPECT_EQ(reader.read(0, std::as_writable_bytes(std::span(bytes))), reader.info().count);
  return bytes;
}

/// Returns the values of a field, by its name in the file.
template <class Source>
std::vector<double> values_of(Source& source, const Schema& schema, std::uint64_t count, const std::string& name) {
  const auto records = all_records(source, schema, count);
  for (const Field& field : schema.fields) {
    if (field.name != name) continue;
    std::vector<double> values;
    for (std::uint64_t i = 0; i < count; ++i) values.push_back(value_of(field, records.data() + i * schema.stride));
    return values;
  }
  throw std::runtime_error("no field " + name);
}

inline std::vector<double> values_of(Reader& reader, const std::string& name) {
  return values_of(reader, reader.info().schema, reader.info().count, name);
}

inline std::vector<std::string> field_names(const Schema& schema) {
  std::vector<std::string> names;
  for (const Field& field : schema.fields) names.push_back(field.name);
  return names;
}

inline OutputPlan plan_for(const std::filesystem::path& path, std::uint64_t count, Schema schema = {}) {
  OutputPlan plan;
  plan.path = path;
  plan.schema = std::move(schema);
  plan.count = count;
  return plan;
}

/// Writes `records` in two calls and completes the file.
inline void write_all(const OutputPlan& plan, std::span<const std::byte> records) {
  const auto writer = create_writer(plan);
  const std::size_t half = plan.count / 2 * plan.schema.stride;
  writer->write(records.first(half));
  writer->write(records.subspan(half));
  writer->finish();
}

}  // namespace pointsweep
