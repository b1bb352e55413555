// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pointsweep/verify/formulas/ground_raster.h"
#include "pointsweep/verify/search/nearest_in_stream.h"
#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {
namespace {

constexpr double kGround = 2, kUnclassified = 1;

class GroundFormula final : public CloudFormula {
 public:
  explicit GroundFormula(const FormulaSetup& stage)
      : parameters_{stage.options.number("cell"), stage.options.number("slope"), stage.options.number("window"),
                    stage.options.number("threshold"), stage.options.number("scalar")},
        all_returns_(stage.options.word("returns") == "all"),
        noise_(stage.options.word("noise") == "yes") {
    const std::vector<Attribute>& reads = stage.contract.reads;
    for (std::size_t r = 0; r < reads.size(); ++r) {
      if (reads[r].name == "classification") class_ = r;
      if (reads[r].name == "return_number") number_ = r;
      if (reads[r].name == "number_of_returns") returns_ = r;
    }
  }

  void prepare(const CloudInput& in) override {
    std::vector<ColumnSource> columns;
    for (std::size_t r = 0; r < in.reads.size(); ++r) columns.push_back(in.source(r));
    const auto for_each_part = [&](const auto& use) {
      in.rows.for_each(columns, [&](std::uint64_t, Vec3 p, std::span<const double> values) {
        if (is_finite(p) && takes_part(values)) use(p);
      });
    };
    std::vector<double> x, y;  // cell numbers of the points
    std::uint64_t points = 0;
    for_each_part([&](Vec3 p) {
      x.push_back(formulas::cell_number(p.x, parameters_.cell)),
          y.push_back(formulas::cell_number(p.y, parameters_.cell));
      if (++points % kTidyPoints == 0) tidy(x), tidy(y);
    });
    if (points == 0) return;
    tidy(x), tidy(y);
    const std::size_t reach = parameters_.reach(), radius = parameters_.radius();
    formulas::CellNumbers columns_of_cells(std::move(x), reach, radius), rows_of_cells(std::move(y), reach, radius);
    const double cells = static_cast<double>(columns_of_cells.count()) * static_cast<double>(rows_of_cells.count());
    const double bytes = cells * formulas::GroundRaster::kCellBytes;
    if (bytes > static_cast<double>(in.rows.memory_bytes()))
      throw NotTold(fmt::format("its raster has {:.3g} cells and needs --memory {}", cells,
                                bytes < 1e18 ? bytes_text(static_cast<std::uint64_t>(bytes)) : "beyond any machine"));
    raster_.emplace(parameters_, std::move(columns_of_cells), std::move(rows_of_cells));
    for_each_part([&](Vec3 p) { raster_->add(p.x, p.y, p.z); });
    raster_->finish();
  }

  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput&) override {
    std::vector<Estimates> made;
    std::vector<double> values;
    for (const CloudPoint& p : points) {
      values.clear();
      bool in_doubt = false;
      for (const formulas::Estimate& e : p.reads) {
        values.push_back(static_cast<double>(e.value.x));
        in_doubt = in_doubt || e.error > 0 || e.may_be_undefined;
      }
      made.push_back({in_doubt ? formulas::open() : class_of(p.at.position, values)});
    }
    return made;
  }

 private:
  static constexpr std::uint64_t kTidyPoints = 1 << 22;

  static void tidy(std::vector<double>& numbers) {
    std::ranges::sort(numbers);
    numbers.erase(std::ranges::unique(numbers).begin(), numbers.end());
  }
  /// Returns whether the filter uses the point: a last return that is not noise, unless the options admit others or the
  /// attributes are absent.
  bool takes_part(std::span<const double> values) const {
    if (class_ && !noise_ && (values[*class_] == 7 || values[*class_] == 18)) return false;
    return all_returns_ || !number_ || !returns_ || !(values[*number_] < values[*returns_]);
  }

  formulas::Estimate class_of(Vec3 p, std::span<const double> values) const {
    if (takes_part(values)) {
      const std::optional<bool> ground = raster_->is_ground(p.x, p.y, p.z);
      if (!ground) return formulas::open();
      if (*ground) return formulas::exactly(kGround);
    }
    const double old = class_ ? values[*class_] : kUnclassified;
    const bool stays = old >= 0 && old <= 255 && old != kGround;
    return formulas::exactly(stays ? std::floor(old) : kUnclassified);
  }

  formulas::GroundParameters parameters_;
  bool all_returns_, noise_;
  std::optional<std::size_t> class_, number_, returns_;  ///< indices of the attributes read
  std::optional<formulas::GroundRaster> raster_;
};

class HeightFormula final : public CloudFormula {
 public:
  explicit HeightFormula(const FormulaSetup& stage) : k_(static_cast<std::size_t>(stage.options.whole("k"))) {}
  void prepare(const CloudInput& in) override { in.rows.require(std::array{in.source(0)}); }
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    const std::array classes = {in.source(0)};
    const PointsOfCloud ground = [&](const auto& take) {
      in.rows.for_each(classes, [&](std::uint64_t row, Vec3 p, std::span<const double> values) {
        if (values[0] == kGround) take(row, p);
      });
    };
    const std::vector<Vec3> places = positions_of(points);
    const auto nearest =
        nearest_of_cloud(places, ground, in.rows.count(), {.most = k_, .space = NearestInStream::Space::plane});
    std::vector<Estimates> made;
    std::vector<formulas::GroundPoint> below;
    for (std::size_t i = 0; i < points.size(); ++i) {
      below.clear();
      for (const NearPoint& g : nearest[i]) below.push_back({g.distance2, g.position.z});
      made.push_back({formulas::height_above(places[i].z, below)});
    }
    return made;
  }

 private:
  std::size_t k_;
};

}  // namespace

std::vector<NamedCloudFormula> ground_formulas() {
  return {{"ground", cloud_formula_made<GroundFormula>}, {"height", cloud_formula_made<HeightFormula>}};
}

}  // namespace pointsweep
