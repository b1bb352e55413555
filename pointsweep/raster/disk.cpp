// SPDX-License-Identifier: MIT
#include "pointsweep/raster/disk.h"

#include <algorithm>

#include "pointsweep/threads.h"

namespace pointsweep {

Disk::Disk(std::size_t radius) {
  for (std::size_t dy = 0, dx = radius; dy <= radius; ++dy) {
    while (dx * dx + dy * dy > radius * radius) --dx;
    half_widths_.push_back(dx);
  }
}

std::size_t DiskMinima::complete(bool ended) const {
  return ended ? given_ : given_ - std::min(given_, disk_.radius());
}

void DiskMinima::drop(std::size_t number) {
  minima_.erase(minima_.begin(), minima_.begin() + static_cast<std::ptrdiff_t>((number - dropped_) * columns_));
  dropped_ = number;
}

void DiskMinima::add(const double* values, std::size_t rows) {
  minima_.resize((given_ + rows + disk_.radius() - dropped_) * columns_, kNoCell);
  parallel_for((columns_ + kColumnsAtOnce - 1) / kColumnsAtOnce, [&](std::size_t part, unsigned) {
    const std::size_t first = part * kColumnsAtOnce;
    add_part(values, rows, first, std::min(columns_, first + kColumnsAtOnce));
  });
  given_ += rows;
}

/// Minima over 2w + 1 successive cells of a row come from those over 2w - 1; a row of the disk of that width takes
/// them.
void DiskMinima::add_part(const double* values, std::size_t rows, std::size_t first, std::size_t end) {
  const std::size_t radius = disk_.radius(), width = end - first;
  std::vector<double> minima(width + 2 * radius);
  for (std::size_t row = 0; row < rows; ++row) {
    std::ranges::fill(minima, kNoCell);
    const std::size_t from = first - std::min(first, radius), to = std::min(columns_, end + radius);
    std::copy(values + row * columns_ + from, values + row * columns_ + to,
              minima.begin() + static_cast<std::ptrdiff_t>(from + radius - first));
    if (std::ranges::all_of(minima, [](double value) { return value == kNoCell; })) continue;
    // minima[i] is that around column first - radius + w + i.
    double* m = minima.data();
    for (std::size_t w = 0; w <= radius; ++w) {
      if (w > 0)
        for (std::size_t i = 0; i < width + 2 * (radius - w); ++i) m[i] = std::min(std::min(m[i], m[i + 1]), m[i + 2]);
      spread(m + (radius - w), given_ + row, w, first, end);
    }
  }
}

/// Includes the minima `values` in each row of the results for which the disk has this half width at `row`.
void DiskMinima::spread(const double* values, std::size_t row, std::size_t half_width, std::size_t first,
                        std::size_t end) {
  const auto take = [&](std::size_t to) {
    double* minima = this->row(to);
    for (std::size_t c = first; c < end; ++c) minima[c] = std::min(minima[c], values[c - first]);
  };
  for (std::size_t dy = 0; dy <= disk_.radius(); ++dy) {
    if (disk_.half_width(dy) != half_width) continue;
    take(row + dy);
    if (dy > 0 && row >= dy) take(row - dy);
  }
}

}  // namespace pointsweep
