// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/checkpoint/checkpoint.h"

#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include "pointsweep/order/packed.h"

namespace pointsweep {
namespace {

constexpr std::array kCounts = {&Statistics::sweeps,     &Statistics::certified, &Statistics::recalled,
                                &Statistics::degenerate, &Statistics::nonfinite, &Statistics::peak_points};

}  // namespace

void take_counts(Statistics& to, const Statistics& from) {
  for (const auto count : kCounts) to.*count = from.*count;
  to.degenerate_results = from.degenerate_results;
}

std::vector<std::byte> Checkpoint::packed() const {
  Packer out;
  out.put_text(identity);
  out.put(memory_bytes);
  out.put(survey.sample);
  out.put(survey.bounds);
  out.put(survey.exact);
  out.put(survey.axis);
  out.put(survey.dimension);
  out.put(sweep);
  out.put(slab_points);
  for (const auto& part : {&stream, &results, &progress}) out.put(*part);
  out.put(bucket_places);
  out.put(mask);
  out.put<std::uint64_t>(values.size());
  for (const std::vector<double>& value : values) out.put(value);
  for (const auto count : kCounts) out.put(counts.*count);
  out.put<std::uint64_t>(counts.degenerate_results.size());
  for (const DegenerateResults& degenerate : counts.degenerate_results) {
    out.put_text(degenerate.stage);
    out.put(degenerate.count);
    out.put(degenerate.rows);
  }
  return out.bytes();
}

Checkpoint Checkpoint::unpacked(std::span<const std::byte> bytes) {
  Unpacker in(bytes);
  Checkpoint c;
  c.identity = in.get_text();
  c.memory_bytes = in.get<std::uint64_t>();
  c.survey.sample = in.get_vector<Vec3>();
  c.survey.bounds = in.get<Box>();
  c.survey.exact = in.get<bool>();
  c.survey.axis = in.get<int>();
  c.survey.dimension = in.get<double>();
  c.sweep = in.get<std::uint64_t>();
  c.slab_points = in.get<std::uint64_t>();
  for (auto* part : {&c.stream, &c.results, &c.progress}) *part = in.get_vector<std::byte>();
  c.bucket_places = in.get_vector<Vec3>();
  c.mask = in.get<std::uint64_t>();
  const auto values = in.get<std::uint64_t>();
  for (std::uint64_t v = 0; v < values; ++v) c.values.push_back(in.get_vector<double>());
  for (const auto count : kCounts) c.counts.*count = in.get<std::uint64_t>();
  for (auto stages = in.get<std::uint64_t>(); stages > 0; --stages) {
    std::string stage = in.get_text();
    const auto count = in.get<std::uint64_t>();
    c.counts.degenerate_results.push_back({std::move(stage), count, in.get_vector<std::uint64_t>()});
  }
  return c;
}

}  // namespace pointsweep
