// SPDX-License-Identifier: MIT
/// Runs of pipelines on points in memory.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/geometry.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

constexpr std::uint64_t kMega = 1 << 20;

struct RunResult {
  Statistics statistics;
  Schema schema;
  std::vector<std::byte> records;  ///< whole output records

  /// Returns all values of a field, row by row.
  std::vector<double> field(const std::string& name) const {
    const Field& f = schema.fields[*schema.find(name)];
    std::vector<double> values;
    for (std::size_t at = 0; at < records.size(); at += schema.stride)
      values.push_back(value_of(f, records.data() + at));
    return values;
  }
};

/// A writer that stores whole records.
class RecordKeeper final : public Writer {
 public:
  explicit RecordKeeper(std::vector<std::byte>& out) : out_(out) {}
  void write(std::span<const std::byte> records) override { out_.insert(out_.end(), records.begin(), records.end()); }
  void finish() override {}

 private:
  std::vector<std::byte>& out_;
};

/// Returns the chain of a pipeline for a cloud without known facts.
inline Chain chain_of_any_cloud(const std::string& pipeline) { return build_chain(parse_pipeline(pipeline), Facts{}); }

/// Returns options for slabs and cells so small that every boundary case happens.
inline EngineOptions small_slabs(std::uint64_t slab_points, std::uint32_t cell_points, unsigned threads = 2,
                                 bool spill = false) {
  EngineOptions options;
  options.slab_points = slab_points;
  options.cell_points = cell_points;
  options.resources.threads = threads;
  options.resources.memory_bytes = 1ull << 30;
  options.spill = spill;
  return options;
}

inline RunResult run_in_memory(InputCloud& cloud, const Chain& chain, const EngineOptions& options) {
  RunResult result;
  Outputs outputs;
  outputs.writer = [&](const OutputPlan& plan) {
    result.schema = plan.schema;
    return std::make_unique<RecordKeeper>(result.records);
  };
  result.statistics = run(cloud, chain, outputs, options);
  return result;
}

inline RunResult run_in_memory(const std::vector<Vec3>& points, const Chain& chain, const EngineOptions& options) {
  std::vector<double> xyz;
  for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  InputCloud cloud(std::move(readers));
  return run_in_memory(cloud, chain, options);
}

}  // namespace pointsweep
