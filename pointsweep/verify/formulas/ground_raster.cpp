// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/ground_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pointsweep::formulas {
namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Replaces each value by the least among itself and the values up to `half` places before and after it (van Herk
/// 1992).
void least_along(std::vector<double>& line, std::size_t half, std::vector<double>& forth, std::vector<double>& back) {
  const std::size_t block = 2 * half + 1, n = line.size(), padded = (n + 2 * half + block - 1) / block * block;
  forth.assign(padded, kFar), back.assign(padded, kFar);
  for (std::size_t i = 0; i < n; ++i) forth[i + half] = back[i + half] = line[i];
  for (std::size_t i = 0; i < padded; ++i)
    if (i % block != 0) forth[i] = std::min(forth[i], forth[i - 1]);
  for (std::size_t i = padded; i-- > 0;)
    if (i % block != block - 1) back[i] = std::min(back[i], back[i + 1]);
  for (std::size_t i = 0; i < n; ++i) line[i] = std::min(back[i], forth[i + 2 * half]);
}

double difference(double before, double here, double behind, double cell) {
  if (!std::isnan(before) && !std::isnan(behind)) return (behind - before) / (2 * cell);
  if (!std::isnan(behind)) return (behind - here) / cell;
  return std::isnan(before) ? 0 : (here - before) / cell;
}

}  // namespace

double cell_number(double coordinate, double cell) {
  constexpr double most = std::numeric_limits<double>::max();
  return std::clamp(std::floor(coordinate / cell), -most, most);
}

std::size_t GroundParameters::radius() const { return static_cast<std::size_t>(std::ceil(window / cell)); }

CellNumbers::CellNumbers(std::vector<double> numbers, std::size_t reach, std::size_t radius)
    : numbers_(std::move(numbers)) {
  std::ranges::sort(numbers_);
  numbers_.erase(std::unique(numbers_.begin(), numbers_.end()), numbers_.end());
  // Number of cells to which a wider gap between occupied cells shrinks: no filling of holes, disk or slope reaches
  // across so many cells.
  const auto apart = static_cast<double>(2 * reach + 2 * radius + 4);
  std::size_t place = reach + 3;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (i > 0) place += static_cast<std::size_t>(std::min(apart, numbers_[i] - numbers_[i - 1]));
    places_.push_back(place);
  }
  count_ = place + reach + 4;
}

std::size_t CellNumbers::place(double number) const {
  return places_[static_cast<std::size_t>(std::ranges::lower_bound(numbers_, number) - numbers_.begin())];
}

GroundRaster::GroundRaster(const GroundParameters& parameters, CellNumbers columns, CellNumbers rows)
    : parameters_(parameters),
      columns_(std::move(columns)),
      rows_(std::move(rows)),
      lowest_(columns_.count() * rows_.count(), kAbsent) {}

void GroundRaster::add(double x, double y, double z) {
  double& lowest =
      lowest_[at(columns_.place(cell_number(x, parameters_.cell)), rows_.place(cell_number(y, parameters_.cell)))];
  if (!(lowest <= z)) lowest = z;
}

GroundRaster::Cells GroundRaster::filled(const Cells& cells) const {
  const std::size_t nx = columns_.count(), ny = rows_.count(), reach = parameters_.reach();
  Cells sums(cells.size(), 0), weights(cells.size(), 0), other_sums(cells.size(), 0), other_weights(cells.size(), 0);
  // For each cell of a line, adds value / distance to `sum` and 1 / distance to `weight`, for the nearest value before
  // the cell and for the nearest value after it, if at most `reach` cells away.
  const auto along = [&](std::size_t first, std::size_t step, std::size_t length, Cells& sum, Cells& weight) {
    for (const bool forth : {true, false}) {
      double value = kAbsent;
      std::size_t distance = 0;
      for (std::size_t n = 0; n < length; ++n) {
        const std::size_t i = first + (forth ? n : length - 1 - n) * step;
        ++distance;
        if (!std::isnan(value) && distance <= reach) {
          sum[i] += value / static_cast<double>(distance);
          weight[i] += 1 / static_cast<double>(distance);
        }
        if (!std::isnan(cells[i])) value = cells[i], distance = 0;
      }
    }
  };
  for (std::size_t row = 0; row < ny; ++row) along(row * nx, 1, nx, sums, weights);
  for (std::size_t column = 0; column < nx; ++column) along(column, nx, ny, other_sums, other_weights);
  Cells result(cells);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double weight = weights[i] + other_weights[i];
    if (std::isnan(cells[i]) && weight > 0) result[i] = (sums[i] + other_sums[i]) / weight;
  }
  return result;
}

GroundRaster::Cells GroundRaster::least_of_disks(const Cells& cells, std::size_t radius) const {
  const std::size_t nx = columns_.count(), ny = rows_.count();
  Cells result(cells.size(), kFar);
  std::vector<double> line, forth, back;
  for (std::size_t row = 0; row < ny; ++row) {
    for (std::size_t dy = 0; dy <= radius; ++dy) {
      std::size_t half = 0;
      while ((half + 1) * (half + 1) + dy * dy <= radius * radius) ++half;
      line.assign(cells.begin() + static_cast<std::ptrdiff_t>(row * nx),
                  cells.begin() + static_cast<std::ptrdiff_t>((row + 1) * nx));
      for (double& v : line)
        if (std::isnan(v)) v = kFar;
      least_along(line, half, forth, back);
      const auto lower = [&](std::size_t to) {
        for (std::size_t i = 0; i < nx; ++i) result[to * nx + i] = std::min(result[to * nx + i], line[i]);
      };
      if (row >= dy) lower(row - dy);
      if (dy > 0 && row + dy < ny) lower(row + dy);
    }
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (std::isnan(cells[i])) result[i] = kAbsent;
  return result;
}

/// Computes an opening: the least value in each disk, then the greatest of these values in each disk.
GroundRaster::Cells GroundRaster::opened(const Cells& cells, std::size_t radius) const {
  Cells least = least_of_disks(cells, radius);
  for (double& v : least) v = -v;
  Cells result = least_of_disks(least, radius);
  for (double& v : result) v = -v;
  return result;
}

void GroundRaster::finish() {
  const Cells first = filled(lowest_);
  std::vector<bool> wrong(first.size());
  {
    Cells upside_down(first);
    for (double& v : upside_down) v = -v;
    const Cells open = opened(upside_down, 1);
    for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] = upside_down[i] - open[i] > 5 * parameters_.cell;
  }
  Cells above = first;
  for (std::size_t r = 1; r <= parameters_.radius(); ++r) {
    Cells below = opened(above, r);
    const double most = parameters_.slope * (parameters_.cell * static_cast<double>(r));
    for (std::size_t i = 0; i < wrong.size(); ++i)
      if (above[i] - below[i] > most) wrong[i] = true;
    above = std::move(below);
  }
  for (std::size_t i = 0; i < wrong.size(); ++i)
    if (wrong[i]) lowest_[i] = kAbsent;
  surface_ = filled(lowest_);
}

double GroundRaster::slope(std::size_t column, std::size_t row) const {
  const double here = surface(column, row), cell = parameters_.cell;
  const double gx = difference(surface(column - 1, row), here, surface(column + 1, row), cell);
  const double gy = difference(surface(column, row - 1), here, surface(column, row + 1), cell);
  return std::sqrt(gx * gx + gy * gy);
}

std::optional<bool> GroundRaster::is_ground(double x, double y, double z) const {
  const double cell = parameters_.cell;
  const std::size_t column = columns_.place(cell_number(x, cell)), row = rows_.place(cell_number(y, cell));
  const double cx = x / cell - std::floor(x / cell), cy = y / cell - std::floor(y / cell);
  const std::size_t c0 = cx >= 0.5 ? column : column - 1, r0 = cy >= 0.5 ? row : row - 1;
  const double fx = cx >= 0.5 ? cx - 0.5 : cx + 0.5, fy = cy >= 0.5 ? cy - 0.5 : cy + 0.5;
  double height = surface(column, row), gradient = 0, largest = std::fabs(z);
  bool whole = true;
  for (std::size_t i = 0; i < 4; ++i) {
    const double corner = surface(c0 + i % 2, r0 + i / 2);
    whole = whole && !std::isnan(corner);
    largest = std::max(largest, std::isnan(corner) ? 0 : std::fabs(corner));
  }
  if (whole) {
    const auto between = [&](const auto& value) {
      const double low = value(c0, r0) * (1 - fx) + value(c0 + 1, r0) * fx;
      const double high = value(c0, r0 + 1) * (1 - fx) + value(c0 + 1, r0 + 1) * fx;
      return low * (1 - fy) + high * fy;
    };
    height = between([&](std::size_t c, std::size_t r) { return surface(c, r); });
    gradient = between([&](std::size_t c, std::size_t r) { return slope(c, r); });
  } else {
    if (std::isnan(height)) return false;
    gradient = slope(column, row);
  }
  const double off = std::fabs(z - height), most = parameters_.threshold + parameters_.scalar * gradient;
  const double rounding = 0x1p-48 * (largest + std::fabs(height) + most + parameters_.scalar * largest / cell);
  if (off != most && std::fabs(off - most) <= rounding) return std::nullopt;
  return off <= most;
}

Estimate height_above(double z, std::span<const GroundPoint> nearest) {
  if (nearest.empty()) return exactly(kNaN);
  if (nearest.front().distance2 == 0) return exactly(z - nearest.front().z);
  Real sum = 0, weights = 0, largest = 0;
  for (const GroundPoint& g : nearest) {
    const Real weight = 1 / static_cast<Real>(g.distance2);
    if (weight > 0x1p900L) return open();  // products of such weights overflow float64
    sum += weight * g.z, weights += weight;
    largest = std::max(largest, std::fabs(static_cast<Real>(g.z)));
  }
  const Real height = z - sum / weights;
  const Real error = rounding_of_sum(nearest.size()) * 2 * (largest + std::fabs(static_cast<Real>(z)));
  return scalar(height, error);
}

}  // namespace pointsweep::formulas
