// SPDX-License-Identifier: MIT
/// Compares every point of a run with the formulas of verify/formulas, on neighbourhoods found by the tests' own grid.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/verify/chain_values.h"
#include "pointsweep/verify/rows/cloud_rows.h"
#include "pointsweep/verify/rows/made_values.h"
#include "tests/oracles/grid_neighbors.h"
#include "tests/pipeline/in_memory.h"
#include "tests/support/operators_of.h"

namespace pointsweep {

struct OracleReport {
  std::size_t values = 0;  ///< number of compared values
  std::size_t wrong = 0;
  std::size_t open = 0;                               ///< number of values that the data do not determine
  std::vector<std::string> differences;               ///< sentences about the first differences
  std::map<std::string, std::vector<double>> errors;  ///< by attribute: errors of the values that the data determine
  std::map<std::string, double> largest_use;          ///< by attribute: greatest ratio of an error to the allowed error

  double share_open() const { return values == 0 ? 0 : static_cast<double>(open) / static_cast<double>(values); }
  double median_error(const std::string& attribute) const {
    std::vector<double> sorted = errors.at(attribute);
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

inline std::vector<Vec3> positions_of(RowSource& source) {
  std::vector<Vec3> points;
  for_each_position(source, "reading", {}, [&](std::uint64_t, Vec3 p) { points.push_back(p); });
  return points;
}

/// Returns all finite points with their neighbours, for a chain that needs `rings` rings of neighbours.
inline Surroundings surroundings_of_all(const std::vector<Vec3>& points, const Neighborhood& what, std::size_t rings) {
  const GridNeighbors grid(points);
  Surroundings all;
  std::vector<std::uint32_t> number(points.size());
  for (std::uint32_t row = 0; row < points.size(); ++row) {
    if (!is_finite(points[row])) continue;
    number[row] = static_cast<std::uint32_t>(all.size());
    all.x.push_back(points[row].x), all.y.push_back(points[row].y), all.z.push_back(points[row].z);
    all.row.push_back(row);
  }
  all.list_begin.push_back(0);
  for (const std::uint64_t row : all.row) {
    for (const std::uint32_t neighbor : grid.of(static_cast<std::uint32_t>(row), what.k, what.radius))
      all.neighbors.push_back(number[neighbor]);
    all.list_begin.push_back(all.neighbors.size());
  }
  all.ring_end.assign(rings + 1, all.size());
  return all;
}

/// The values that the formulas give for a chain, and their comparison with the output of a run.
class Oracle {
 public:
  Oracle(InputCloud& cloud, const Chain& chain)
      : source_(cloud),
        values_(with_input_values(operators_of(chain.stages, cloud.schema()), cloud), chain.keep, cloud.schema(),
                chain.neighborhood.rule) {
    const Surroundings all =
        surroundings_of_all(positions_of(source_), with_named_neighborhoods(chain).neighborhood, values_.rings());
    rows_ = all.row;
    const PhaseProgress silent;
    CloudRows rows(source_, source_, -1, std::uint64_t{1} << 30, silent);
    expected_ = values_.evaluate(all, source_, rows);
    for (std::size_t a = 0; a < values_.made().size(); ++a)
      EXPECT_TRUE(values_.is_independent(a)) << values_.made()[a].name << " has no formula";
  }

  OracleReport compare(const RunResult& result) const {
    OracleReport report;
    Schema made;
    for (const Attribute& a : values_.made())
      for (const std::string& field : a.fields) made.append(field, a.type);
    std::size_t field = 0, estimate = 0;
    for (const Attribute& a : values_.made()) {
      const std::size_t width = a.fields.size() / estimates_of(a);
      for (std::size_t e = 0; e < estimates_of(a); ++e, field += width) {
        std::vector<std::optional<FieldPair>> pairs;
        for (std::size_t f = field; f < field + width; ++f) {
          const auto found = pairs_of_field(made, f, result.schema);
          if (!found) return ADD_FAILURE() << made.fields[f].name << " is missing", report;
          pairs.push_back(found->front());
        }
        compare(a.name, MadeValue(pairs), estimate++, result, report);
      }
    }
    return report;
  }

  const ChainResults& expected() const { return expected_; }

 private:
  void compare(const std::string& name, const MadeValue& value, std::size_t estimate, const RunResult& result,
               OracleReport& report) const {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const formulas::Estimate& e = expected_.estimates[i * values_.estimates_per_point() + estimate];
      const std::byte* own = expected_.values.data() + i * values_.result_bytes();
      const std::byte* record = result.records.data() + rows_[i] * result.schema.stride;
      ++report.values;
      if (e.is_open()) {
        ++report.open;
        continue;
      }
      report.errors[name].push_back(static_cast<double>(e.error));
      if (e.error > 0) {
        double& use = report.largest_use[name];
        use = std::max(use, static_cast<double>(value.distance(e, record) / e.error));
      }
      const auto wrong = value.wrong_component(e, own, record);
      if (!wrong) continue;
      if (++report.wrong <= 5)
        report.differences.push_back(fmt::format("row {}: {}", rows_[i], value.difference(*wrong, e, own, record)));
    }
  }

  RowSource source_;
  ChainValues values_;
  std::vector<std::uint64_t> rows_;
  ChainResults expected_;
};

/// Returns options for several slabs, small cells and two threads.
inline EngineOptions streamed(std::uint64_t points, bool spill = false) {
  EngineOptions options;
  options.slab_points = std::max<std::uint64_t>(64, points / 7);
  options.cell_points = points < 5000 ? 64 : 512;
  options.resources.threads = 2;
  options.resources.memory_bytes = std::uint64_t{1} << 30;
  options.spill = spill;
  return options;
}

/// Expects that no value is wrong, and that the data leave at most the share `open` of them undetermined.
inline void expect_right(const OracleReport& report, const std::string& name, double open) {
  EXPECT_EQ(report.wrong, 0u) << name << ": of " << report.values;
  for (const std::string& difference : report.differences) ADD_FAILURE() << name << ": " << difference;
  EXPECT_LE(report.share_open(), open) << name << ": " << report.open << " of " << report.values;
}

/// Runs `chain` with the options of streamed(), and expects the values that the formulas give. The data may leave at
/// most the share `open` of the values undetermined.
inline OracleReport expect_formulas(InputCloud& cloud, const Chain& chain, const std::string& name, double open = 0.001,
                                    bool spill = false) {
  const RunResult result = run_in_memory(cloud, chain, streamed(cloud.count(), spill));
  const OracleReport report = Oracle(cloud, chain).compare(result);
  expect_right(report, name, open);
  return report;
}

inline OracleReport expect_formulas(InputCloud& cloud, const std::string& pipeline, const std::string& name,
                                    double open = 0.001, bool spill = false) {
  return expect_formulas(cloud, build_chain(parse_pipeline(pipeline), cloud), name + ", " + pipeline, open, spill);
}

/// A cloud of points in memory, to which attributes can be added.
class PointCloud {
 public:
  explicit PointCloud(const std::vector<Vec3>& points) {
    for (const Vec3& p : points) xyz_.insert(xyz_.end(), {p.x, p.y, p.z});
    reader_ = std::make_unique<ArrayReader>(std::span<const double>(xyz_));
  }
  PointCloud& with(const std::vector<std::string>& names, std::vector<float> values) {
    singles_.push_back(std::make_unique<std::vector<float>>(std::move(values)));
    reader_->add(names, std::span<const float>(*singles_.back()));
    return *this;
  }
  PointCloud& with(const std::vector<std::string>& names, std::vector<double> values) {
    doubles_.push_back(std::make_unique<std::vector<double>>(std::move(values)));
    reader_->add(names, std::span<const double>(*doubles_.back()));
    return *this;
  }
  InputCloud& cloud() {
    if (!cloud_) {
      std::vector<std::unique_ptr<Reader>> readers;
      readers.push_back(std::move(reader_));
      cloud_ = std::make_unique<InputCloud>(std::move(readers));
    }
    return *cloud_;
  }

 private:
  std::vector<double> xyz_;
  std::vector<std::unique_ptr<std::vector<float>>> singles_;
  std::vector<std::unique_ptr<std::vector<double>>> doubles_;
  std::unique_ptr<ArrayReader> reader_;
  std::unique_ptr<InputCloud> cloud_;
};

}  // namespace pointsweep
