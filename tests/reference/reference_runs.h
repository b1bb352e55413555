// SPDX-License-Identifier: MIT
/// Runs of the reference engine through run(), as programs start them, and checks of their results.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/shapes/registry.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"
#include "tests/support/reference_engine.h"

namespace pointsweep {

using Lists = std::vector<std::vector<std::uint32_t>>;
using Stages = std::vector<ChainStage>;

inline constexpr Order kOrders[] = {Order::input, Order::sweep};

/// An operator that records the rows of the points in the order of their processing. Only for an engine of one thread.
class Passing final : public LocalOperator {
 public:
  explicit Passing(std::vector<std::uint32_t>& rows) : rows_(rows) {}
  std::string name() const override { return "passing"; }
  Contract contract() const override { return {{}, {}, {scalar("passed", Type::u8, "1", "")}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) {
      rows_.push_back(static_cast<std::uint32_t>(in.row(i)));
      out.column<std::uint8_t>(0)[i] = 1;
    }
  }

 private:
  std::vector<std::uint32_t>& rows_;
};

/// Returns options with slabs of 300 points by default, so that small clouds have many slabs.
inline EngineOptions by(Engine engine, Order order = Order::input, std::uint64_t slab_points = 300) {
  EngineOptions options;
  options.engine = engine;
  options.order = order;
  options.slab_points = slab_points;
  options.resources.memory_bytes = 1u << 30;
  return options;
}

inline Box bounds_of(const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& p : points)
    if (is_finite(p)) box.include(p);
  return box;
}

/// Returns the rows in canonical order along the longest axis; points that are not finite come last, by row.
inline std::vector<std::uint32_t> canonical_rows(const std::vector<Vec3>& points) {
  const int axis = bounds_of(points).longest_axis();
  std::vector<std::uint32_t> rows(points.size());
  std::iota(rows.begin(), rows.end(), 0u);
  const auto end = std::stable_partition(rows.begin(), rows.end(), [&](auto row) { return is_finite(points[row]); });
  const auto key = [&](std::uint32_t row) {
    const Vec3 p = points[row];
    return std::tuple(p[axis], p.x, p.y, p.z, row);
  };
  std::sort(rows.begin(), end, [&](auto a, auto b) { return key(a) < key(b); });
  return rows;
}

/// Returns the row of each output record.
inline std::vector<std::uint32_t> rows_of_records(const std::vector<Vec3>& points, Order order) {
  if (order == Order::sweep) return canonical_rows(points);
  std::vector<std::uint32_t> rows(points.size());
  std::iota(rows.begin(), rows.end(), 0u);
  return rows;
}

/// Returns the records of an output in the order `order`, by row.
inline std::vector<std::string> records_by_row(const RunResult& result, const std::vector<Vec3>& points, Order order) {
  std::vector<std::string> records(points.size());
  const std::vector<std::uint32_t> rows = rows_of_records(points, order);
  const std::size_t stride = result.schema.stride;
  for (std::size_t i = 0; i < rows.size(); ++i)
    records[rows[i]].assign(reinterpret_cast<const char*>(result.records.data()) + i * stride, stride);
  return records;
}

struct NeighborRun {
  Statistics statistics;
  Lists lists;                         ///< by row; the first `width` neighbours
  std::vector<double> counts;          ///< |N_i|, by row
  std::vector<std::uint32_t> entered;  ///< rows in the order in which the engine processed the points
  std::vector<std::string> records;    ///< records of the output, by row
};

/// Returns the neighbours of all points of a cloud at `points`, up to `width` of each point.
inline NeighborRun neighbor_run(InputCloud& cloud, const std::vector<Vec3>& points, const Neighborhood& neighborhood,
                                std::size_t width, const EngineOptions& options) {
  NeighborRun run;
  Chain chain{neighborhood,
              {operators::neighborhood_size(), std::make_shared<NeighborRows>(width, points.size(), false)},
              {"neighbor_count", "neighbors"}};
  if (options.engine == Engine::reference)
    chain.stages.insert(chain.stages.begin(), std::make_shared<Passing>(run.entered));
  const RunResult result = run_in_memory(cloud, chain, options);
  run.statistics = result.statistics;
  run.records = records_by_row(result, points, options.order);
  const Field& first = result.schema.fields[*result.schema.find("neighbor_0")];
  const Field& count = result.schema.fields[*result.schema.find("neighbor_count")];
  for (const std::string& record : run.records) {
    const auto* bytes = reinterpret_cast<const std::byte*>(record.data());
    run.counts.push_back(value_of(count, bytes));
    std::vector<std::uint32_t>& list = run.lists.emplace_back(width);
    std::memcpy(list.data(), bytes + first.offset, width * sizeof(std::uint32_t));
    std::erase(list, std::numeric_limits<std::uint32_t>::max());
  }
  return run;
}

/// Returns how many lists differ.
inline std::uint64_t differing(const Lists& a, const Lists& b) {
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
  return count;
}

inline InputCloud cloud_of(const std::vector<double>& xyz) {
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  return InputCloud(std::move(readers));
}

inline std::vector<double> xyz_of(const std::vector<Vec3>& points) {
  std::vector<double> xyz;
  for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  return xyz;
}

inline NeighborRun neighbor_run(const std::vector<Vec3>& points, const Neighborhood& neighborhood, std::size_t width,
                                const EngineOptions& options) {
  const std::vector<double> xyz = xyz_of(points);
  InputCloud cloud = cloud_of(xyz);
  return neighbor_run(cloud, points, neighborhood, width, options);
}

inline CloudShape generated(const std::string& name) {
  return [shape = std::shared_ptr<const Shape>(create_shape(name))](std::mt19937_64& random) {
    Rng rng(random(), 0);
    return shape->sample(rng).position;
  };
}

/// Returns the hostile shapes, and shapes with regions so sparse that the exact engine would give them separate slabs.
inline std::vector<std::pair<std::string, CloudShape>> trying_shapes() {
  std::vector<std::pair<std::string, CloudShape>> shapes = hostile_shapes();
  shapes.emplace_back("terrestrial scan", generated("tls"));
  shapes.emplace_back("statue among outliers", [statue = generated("statue")](auto& r) {
    return uniform(r) < 0.02 ? Vec3{40 * (uniform(r) - 0.5), 40 * (uniform(r) - 0.5), 40 * (uniform(r) - 0.5)}
                             : statue(r);
  });
  shapes.emplace_back("dense sheets in a thin volume", [](auto& r) {
    const double x = 10 * uniform(r);
    return uniform(r) < 0.1 ? Vec3{x, uniform(r), uniform(r)}
                            : Vec3{std::floor(x) + 1e-3 * uniform(r), uniform(r), uniform(r)};
  });
  return shapes;
}

}  // namespace pointsweep
