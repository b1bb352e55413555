// SPDX-License-Identifier: MIT
/// Ground points, found by a filter of the raster of the lowest points (T. J. Pingel, K. C. Clarke and W. A. McBride,
/// "An improved simple morphological filter for the terrain classification of airborne LIDAR data", ISPRS Journal of
/// Photogrammetry and Remote Sensing 77, 2013).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/ground/ground_work.h"
#include "pointsweep/raster/cells.h"
#include "pointsweep/raster/ground_surface.h"

namespace pointsweep {
namespace {

constexpr double kMostCells = 1000;

const OptionTable<GroundOptions>& ground_options() {
  static const OptionTable<GroundOptions> table = {
      only_choice<GroundOptions>("method", "smrf", "filter that finds the ground; there is only this one"),
      option("cell", &GroundOptions::cell, "edge length of the cells of the raster, whose lines lie at multiples of it",
             {.least = kAboveZero, .unit = "length"}),
      option("slope", &GroundOptions::slope, "steepest slope of the ground, rise over run; steeper shapes are objects"),
      option("window", &GroundOptions::window, "about half the width of the widest object, such as a building",
             {.unit = "length"}),
      option("threshold", &GroundOptions::threshold,
             "largest distance from a point of the ground to the surface, where that is level", {.unit = "length"}),
      option("scalar", &GroundOptions::scalar,
             "length added to the threshold for each unit of the slope of the surface", {.unit = "length"}),
      option("returns", &GroundOptions::all_returns,
             "use the last returns of pulses or all returns, where the cloud numbers them",
             {.choices = {"last", "all"}}),
      option("noise", &GroundOptions::noise,
             "let points of the classes 7 and 18 (noise) take part, where the cloud has classes",
             {.choices = {"no", "yes"}})};
  return table;
}

/// CPU seconds of the openings of one cell by all disks, divided by the square of the largest radius, on one core of
/// 2.6 GHz.
constexpr double kCellSeconds = 2.5e-9;

struct RasterSize {
  std::size_t columns = 0;  ///< largest number of columns of a band of rows
  double cells = 0;         ///< number of cells of all bands
};

/// Estimates the size of the raster from a sample of the points.
RasterSize raster_of(std::span<const Vec3> sample, int axis, double cell, AxisRule rule) {
  std::vector<std::pair<double, double>> cells;  // row, column
  for (const Vec3& p : sample) {
    const double x = std::floor(p.x / cell), y = std::floor(p.y / cell);
    cells.emplace_back(axis == 0 ? std::pair{x, y} : std::pair{y, x});
  }
  std::ranges::sort(cells);
  BandedRows rows(rule);
  CellAxis columns(rule);
  RasterSize size;
  const auto end_band = [&] {
    columns.finish();
    size.columns = std::max(size.columns, columns.size());
    size.cells += static_cast<double>(rows.rows()) * static_cast<double>(columns.size());
    columns = CellAxis(rule);
  };
  for (const auto& [row, column] : cells) {
    if (rows.begins_band(row)) end_band();
    rows.place_of(row);
    columns.add(column);
  }
  end_band();
  return size;
}

/// Makes classification: 2 for ground. Other points keep the class of the input or of an earlier stage, except that
/// class 2, a missing class and one outside of 0 to 255 become 1. Only points that take part can be ground: last
/// returns whose class is neither 7 nor 18 (noise). Options admit all returns, or noise. Attributes that the cloud
/// lacks exclude no point.
class Ground final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges, and for a window of more than kMostCells cells.
  explicit Ground(const GroundOptions& options) : options_(options) {
    ground_options().declare(*this, options);
    if (options.window / options.cell > kMostCells)
      fail_usage("ground: the window {} is more than {} cells of {}; choose larger cells or a smaller window.",
                 options.window, kMostCells, options.cell);
  }
  std::string name() const override { return "ground"; }
  InOrderContract in_order_contract() const override {
    return {.reads = reads_,
            .makes = {classification_attribute()},
            .places = Places::in_plane,
            .arrival = "those of a row of cells together"};
  }
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override {
    auto bound = std::make_shared<Ground>(*this);
    bound->reads_.clear();
    const auto read = [&](const char* name) -> std::optional<std::size_t> {
      const std::optional<Attribute> value = single_value(name, input, made);
      if (!value) return {};
      bound->reads_.push_back(*value);
      return bound->reads_.size() - 1;
    };
    bound->numbers_.classification = read("classification");
    if (options_.all_returns) return bound;
    bound->numbers_.return_number = read("return_number");
    bound->numbers_.number_of_returns = read("number_of_returns");
    return bound;
  }
  Vec3 place_of(Vec3 position) const override {
    constexpr double kMost = std::numeric_limits<double>::max();
    const auto number = [&](double c) { return std::clamp(std::floor(c / options_.cell), -kMost, kMost); };
    return {number(position.x), number(position.y), 0};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override {
    return std::make_unique<GroundWork>(options_, rule(), numbers_, reads_.size(), setup);
  }
  /// Returns the reach in cells, with R, the radius of the largest disk. The surface at a point depends on the two
  /// nearest cells along each axis and their slopes; a hole in the surface is filled from cells at most 3R + 3 away;
  /// and disks of all radii up to R, one after another, open a raster whose holes were filled from 3R + 3 cells away.
  std::optional<Reach> reach() const override {
    const auto radius = static_cast<double>(rule().radius);
    return Reach{.distance = radius * (radius + 1) + 2 * (3 * radius + 3) + 4};
  }
  /// Returns a function that chooses the points that other parts of the cloud need: in each cell, the lowest point that
  /// takes part.
  ChoosePoints for_other_parts() const override {
    return [this](const OrderedPoints& points) {
      std::map<std::pair<double, double>, std::uint32_t> lowest;
      const std::size_t values = reads_.size();
      for (std::uint32_t i = 0; i < points.rows.size(); ++i) {
        if (!takes_part_in_ground(options_, numbers_, points.values.data() + i * values)) continue;
        const Vec3 cell = place_of(points.positions[i]);
        const auto [known, is_new] = lowest.try_emplace({cell.x, cell.y}, i);
        if (!is_new && points.positions[i].z < points.positions[known->second].z) known->second = i;
      }
      std::vector<std::uint32_t> chosen;
      for (const auto& [cell, i] : lowest) chosen.push_back(i);
      return chosen;
    };
  }
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override {
    const std::size_t columns = raster_of(cloud.sample, cloud.axis, options_.cell, rule().axis_rule()).columns;
    return least_ground_bytes(rule(), columns + columns / 8);
  }
  InOrderEffort effort(const CloudEstimate& cloud) const override {
    const auto radius = static_cast<double>(rule().radius);
    const double cells = raster_of(cloud.sample, cloud.axis, options_.cell, rule().axis_rule()).cells;
    return {.seconds = kCellSeconds * cells * radius * radius,
            .cause = "The window",
            .text = fmt::format("disks of up to {} cells over a raster of about {:.2g} cells", radius, cells),
            .remedy = "larger cells or a smaller window take less"};
  }

 private:
  GroundRule rule() const {
    return {options_.cell, options_.slope, static_cast<std::size_t>(std::ceil(options_.window / options_.cell))};
  }

  GroundOptions options_;
  std::vector<Attribute> reads_;
  GroundValues numbers_;
};

}  // namespace

OperatorDeclaration ground_declaration() {
  return {.name = "ground",
          .meaning = "finds the points of the ground by a morphological filter and gives them class 2",
          .options = ground_options().declarations(),
          .make = ground_options().maker<Ground>(),
          .formula =
              "Cell of p: (⌊x / cell⌋, ⌊y / cell⌋); R = ⌈window / cell⌉. Rasters have absent cells.\n"
              "1. Z: the least z of the points of a cell that take part. F(Z): a cell without one becomes "
              "((W/w + E/e) + (S/s + N/n)) / ((1/w + 1/e) + (1/s + 1/n)), W, E, S, N: the nearest "
              "values in its row and column, at most 3R + 3 cells away; w, e, s, n: their distances; "
              "missing sides count 0. Without any it is absent.\n"
              "2. open(A, r): the greatest, over a disk dx² + dy² <= r², of the least of A over a disk; "
              "absent cells count for nothing and stay absent. Pits: -F(Z) - open(-F(Z), 1) > 5 cell.\n"
              "3. S_0 = F(Z); S_r = open(S_(r-1), r), r = 1 ... R. Objects: for some r "
              "S_(r-1) - S_r > slope (cell r).\n"
              "4. G = F(Z without the cells of pits and objects); g = sqrt(gx² + gy²) in each cell, by "
              "central differences of G, one-sided next to an absent cell, 0 between two of them.\n"
              "5. G(p), g(p): bilinear between the centres of the four cells around p; where one of these "
              "is absent, those of the cell of p.\n"
              "Ground: points that take part with |z - G(p)| <= threshold + scalar g(p).",
          .source =
              "Pingel, Clarke and McBride, An improved simple morphological filter for the terrain classification of "
              "airborne LIDAR data (ISPRS Journal 77, 2013). The paper fills holes by a system of springs over the "
              "whole raster, in which every cell depends on every other; F is local, so that tiles, their order and "
              "points far away change nothing. Its optional net for large buildings is not there",
          .undefined =
              "Points that do not take part, and those where G is absent, are not ground. What is not ground keeps its "
              "class, but 1 in the place of 2, and 1 where the cloud has no classes. Points without a finite place "
              "keep their class.",
          .cost =
              "a pass that puts the points in order by rows of cells and reads them twice, without a search; memory "
              "holds about 6R rows of cells for each of the R disks, or, within a smaller --memory, for one disk at a "
              "time",
          .attributes = {{.name = "classification",
                          .meaning = "class of LAS: 2 where the point is ground; else that of the input, but 1 in the "
                                     "place of 2, and 1 where it has none"}},
          .example = "knn(k=8) | sor | where(outlier == 0) | ground(cell=1, window=18)"};
}

ChainStage operators::ground(const GroundOptions& options) { return std::make_shared<Ground>(options); }

}  // namespace pointsweep
