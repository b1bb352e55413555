// SPDX-License-Identifier: MIT
#include "pointsweep/operators/ground/ground_work.h"

#include <cmath>

namespace pointsweep {
namespace {

constexpr double kGround = 2, kUnclassified = 1, kLowNoise = 7, kHighNoise = 18;
/// Number of rows of cells that a point needs before and after its own row: the slopes of the adjacent cells depend on
/// the cells next to them.
constexpr std::size_t kRowsAround = 2;

/// Returns the slope along one axis by a central difference of the cells on both sides; by a one-sided difference next
/// to one absent cell, and 0 between two.
double difference(double before, double here, double behind, double cell) {
  if (before != kNoCell && behind != kNoCell) return (behind - before) / (2 * cell);
  if (behind != kNoCell) return (behind - here) / cell;
  return before != kNoCell ? (here - before) / cell : 0;
}

/// The position of a coordinate between the centres of two cells.
struct Between {
  int first;        ///< number of the lower cell, relative to the cell of the coordinate: -1 or 0
  double fraction;  ///< share of the way from `first` to the next cell, in [0, 1)
};

Between between_centers(double coordinate, double cell) {
  const double cells = coordinate / cell, fraction = cells - std::floor(cells);
  return fraction >= 0.5 ? Between{0, fraction - 0.5} : Between{-1, fraction + 0.5};
}

double bilinear(const double (&corners)[2][2], double x, double y) {
  const double low = corners[0][0] * (1 - x) + corners[0][1] * x;
  const double high = corners[1][0] * (1 - x) + corners[1][1] * x;
  return low * (1 - y) + high * y;
}

}  // namespace

Attribute classification_attribute() {
  Attribute a = scalar("classification", Type::u8, "1", "class of LAS: 2 for ground");
  a.fill = std::byte{1};
  return a;
}

bool takes_part_in_ground(const GroundOptions& options, const GroundValues& numbers, const double* values) {
  if (numbers.classification && !options.noise) {
    const double c = values[*numbers.classification];
    if (c == kLowNoise || c == kHighNoise) return false;
  }
  if (!numbers.return_number || !numbers.number_of_returns) return true;
  return !(values[*numbers.return_number] < values[*numbers.number_of_returns]);
}

GroundWork::GroundWork(const GroundOptions& options, const GroundRule& rule, const GroundValues& numbers,
                       std::size_t values, const InOrderSetup& setup)
    : options_(options),
      rule_(rule),
      numbers_(numbers),
      values_(values),
      setup_(setup),
      lowest_(rule.axis_rule(), setup.make_scratch()),
      rows_(rule.axis_rule()) {}

void GroundWork::add(unsigned round, const OrderedPoints& points, Findings& findings) {
  round == 0 ? add_lowest(points) : classify(points, findings);
}

void GroundWork::end(unsigned round, Findings&) {
  if (round > 0) return;
  lowest_.finish();
  require_ground_memory(rule_, lowest_.most_columns(), setup_.memory_bytes);
}

std::string GroundWork::warning() const {
  if (lowest_.most_columns() > 0 || !has_points_) return "";
  return "no point takes part, so that none is ground: all are noise (class 7 or 18) or no last returns; see the "
         "options noise and returns.";
}

void GroundWork::open_band(std::size_t number) {
  surface_.reset();
  opened_ = number;
  band_.emplace(lowest_, number);
  surface_.emplace(ground_surface(*band_, rule_, setup_.memory_bytes, setup_.make_scratch), kRowsAround);
}

std::uint8_t GroundWork::class_of_others(const double* values) const {
  const double c = numbers_.classification ? values[*numbers_.classification] : kUnclassified;
  const bool is_class = c >= 0 && c <= 255 && c != kGround;
  return static_cast<std::uint8_t>(is_class ? c : kUnclassified);
}

void GroundWork::add_lowest(const OrderedPoints& points) {
  has_points_ = has_points_ || !points.rows.empty();
  for (std::size_t i = 0; i < points.rows.size(); ++i)
    if (takes_part(points.values.data() + i * values_))
      lowest_.add(row_number(points.places[i]), column_number(points.places[i]), points.positions[i].z);
}

void GroundWork::classify(const OrderedPoints& points, Findings& findings) {
  for (std::size_t i = 0; i < points.rows.size(); ++i) {
    const double* values = points.values.data() + i * values_;
    std::uint8_t result = class_of_others(values);
    if (takes_part(values)) {
      const Cell cell = cell_of(points.places[i]);
      surface_->move_to(cell.row);
      if (is_ground(points.positions[i], cell)) result = static_cast<std::uint8_t>(kGround);
    }
    findings.rows.push_back(points.rows[i]);
    findings.values.push_back(std::byte{result});
  }
}

/// Returns the cell of a point, and opens the band of the cell unless it is open. Points come row by row, as in the
/// first round.
GroundWork::Cell GroundWork::cell_of(Vec3 place) {
  const std::uint64_t row = rows_.place_of(row_number(place));
  if (opened_ != rows_.band()) open_band(rows_.band());
  return {row, band_->columns().place_of(column_number(place))};
}

bool GroundWork::is_ground(Vec3 p, Cell cell) const {
  const std::optional<Surface> surface = surface_at(p, cell);
  return surface && std::abs(p.z - surface->z) <= options_.threshold + options_.scalar * surface->slope;
}

std::optional<GroundWork::Surface> GroundWork::surface_at(Vec3 p, Cell cell) const {
  const Between x = between_centers(p.x, options_.cell), y = between_centers(p.y, options_.cell);
  double z[2][2], slopes[2][2];
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      z[j][i] = surface(cell, x.first + i, y.first + j);
      if (z[j][i] != kNoCell) {
        slopes[j][i] = slope(cell, x.first + i, y.first + j);
      } else {
        const double own = surface(cell, 0, 0);
        return own != kNoCell ? std::optional(Surface{own, slope(cell, 0, 0)}) : std::nullopt;
      }
    }
  }
  return Surface{bilinear(z, x.fraction, y.fraction), bilinear(slopes, x.fraction, y.fraction)};
}

/// Returns the surface of the cell that lies `dx` cells east and `dy` cells north of `cell`.
double GroundWork::surface(Cell cell, int dx, int dy) const {
  const int rows = setup_.axis == 0 ? dx : dy, columns = setup_.axis == 0 ? dy : dx;
  return surface_->at(cell.row + static_cast<std::uint64_t>(rows), cell.column + static_cast<std::size_t>(columns));
}

double GroundWork::slope(Cell cell, int dx, int dy) const {
  const double here = surface(cell, dx, dy);
  const double gx = difference(surface(cell, dx - 1, dy), here, surface(cell, dx + 1, dy), options_.cell);
  const double gy = difference(surface(cell, dx, dy - 1), here, surface(cell, dx, dy + 1), options_.cell);
  return std::sqrt(gx * gx + gy * gy);
}

}  // namespace pointsweep
