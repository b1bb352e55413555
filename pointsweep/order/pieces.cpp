// SPDX-License-Identifier: MIT
#include "pointsweep/order/pieces.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <mutex>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/sort.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr std::size_t kCellsPerLimit = 16, kMostLookupCells = 65536;
constexpr double kThinnest = 4;  ///< least thickness of a piece, in median spacings of its points

/// Returns the median spacing at up to 255 evenly chosen points of the sample, pairs of a coordinate and a spacing.
double median_spacing(std::span<const std::pair<double, double>> sample) {
  constexpr std::size_t kLook = 255;
  std::vector<double> spacings;
  const std::size_t every = sample.size() / kLook + 1;
  for (std::size_t i = 0; i < sample.size(); i += every) spacings.push_back(sample[i].second);
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

/// The counts of one thread.
struct Counted {
  explicit Counted(std::size_t pieces) : points(pieces), boxes(pieces) {}

  std::vector<std::uint64_t> points;
  std::vector<Box> boxes;
  std::uint64_t nonfinite = 0;
};

void count_block(const BlockReader& rows, const PieceFinder& finder, int axis, RowBlock& block, Counted& counted) {
  for (std::size_t i = 0; i < rows.count(); ++i) {
    const Vec3 p = rows.position(i);
    if (!is_finite(p)) {
      ++counted.nonfinite;
      continue;
    }
    const std::size_t piece = finder.piece_of(p, p[axis]);
    ++counted.points[piece];
    counted.boxes[piece].include(p);
    block.pieces[piece >= finder.first_sparse_piece()].include(static_cast<std::uint32_t>(piece));
  }
}

void add(PieceCounts& to, const Counted& counted) {
  to.nonfinite += counted.nonfinite;
  for (std::size_t piece = 0; piece < counted.points.size(); ++piece) {
    to.points[piece] += counted.points[piece];
    to.boxes[piece].include(counted.boxes[piece]);
  }
}

}  // namespace

Splitters::Splitters(std::vector<double> limits) : limits_(std::move(limits)) {
  assert(std::ranges::adjacent_find(limits_, std::greater_equal<>()) == limits_.end());
  assert(limits_.size() < std::numeric_limits<std::uint16_t>::max());
  const std::size_t cells = std::clamp<std::size_t>(limits_.size() * kCellsPerLimit, 1, kMostLookupCells);
  last_cell_ = static_cast<double>(cells - 1);
  if (limits_.size() > 1) {
    lo_ = limits_.front();
    scale_ = last_cell_ / (limits_.back() - limits_.front());
  }
  first_.assign(cells + 1, 0);
  for (const double limit : limits_) ++first_[cell_of(limit) + 1];
  for (std::size_t c = 1; c <= cells; ++c) first_[c] = static_cast<std::uint16_t>(first_[c] + first_[c - 1]);
  limits_.push_back(kInf);
}

std::uint32_t Splitters::search(std::size_t cell, double value) const {
  const auto begin = limits_.begin();
  return static_cast<std::uint32_t>(std::upper_bound(begin + first_[cell], begin + first_[cell + 1], value) - begin);
}

std::vector<double> quantile_limits(std::vector<double>& sample, std::size_t pieces) {
  sort_ascending(std::span(sample));
  std::vector<double> limits;
  double previous = kInf;
  for (std::size_t i = 1; i < pieces && !sample.empty(); ++i) {
    const double quantile = sample[i * sample.size() / pieces];
    if (quantile != previous && (limits.empty() || quantile > limits.back()))
      limits.push_back(quantile);
    else if (quantile == previous && limits.back() == quantile)
      limits.push_back(std::nextafter(quantile, kInf));
    previous = quantile;
  }
  return limits;
}

std::vector<double> limits_not_too_near(std::span<const double> limits, std::span<const double> sample,
                                        std::span<const double> spacing) {
  if (spacing.empty()) return {limits.begin(), limits.end()};
  std::vector<std::pair<double, double>> sorted;
  for (std::size_t i = 0; i < sample.size(); ++i) sorted.emplace_back(sample[i], spacing[i]);
  sort_ascending(std::span(sorted));
  std::vector<double> kept;
  auto begin = sorted.begin(), end = begin;
  for (const double limit : limits) {
    end = std::partition_point(end, sorted.end(), [limit](const auto& s) { return s.first < limit; });
    if (begin == end || limit - begin->first < kThinnest * median_spacing({begin, end})) continue;
    kept.push_back(limit);
    begin = end;
  }
  return kept;
}

std::vector<RowBlock> cut_into_blocks(std::uint64_t count, std::uint64_t most, std::span<const RowBox> boxes) {
  std::vector<RowBlock> blocks;
  std::uint64_t row = 0;
  const auto cut_until = [&](std::uint64_t end) {
    const std::uint64_t rows = end - row, parts = (rows + most - 1) / most;
    for (std::uint64_t part = 0, begin = row; part < parts; ++part, row = blocks.back().first_row + blocks.back().rows)
      blocks.push_back({row, begin + rows / parts * (part + 1) + std::min(part + 1, rows % parts) - row, {}});
  };
  for (const RowBox& box : boxes) cut_until(std::clamp(box.first_row + box.rows, row, count));
  cut_until(count);
  return blocks;
}

PieceCounts count_pieces(const PointSource& source, const PieceFinder& finder, int axis, std::vector<RowBlock> blocks,
                         const std::function<void(std::uint64_t rows)>& progress) {
  PieceCounts all{std::vector<std::uint64_t>(finder.pieces()), std::vector<Box>(finder.pieces()), 0, std::move(blocks)};
  std::mutex mutex;
  std::size_t next = 0;
  std::uint64_t done = 0;
  FirstFailure failure;
  const auto next_block = [&]() -> RowBlock* {
    const std::lock_guard lock(mutex);
    if (next == all.blocks.size() || failure.makes_needless(next)) return nullptr;
    return &all.blocks[next++];
  };
  parallel_for(thread_count(), [&](std::size_t, unsigned) {
    Counted counted(finder.pieces());
    BlockReader rows(source, position_columns(source.schema));
    while (RowBlock* const block = next_block()) {
      failure.note_from(static_cast<std::size_t>(block - all.blocks.data()), [&] {
        stop_if_cancelled();
        rows.read(block->first_row, static_cast<std::size_t>(block->rows));
        count_block(rows, finder, axis, *block, counted);
      });
      const std::lock_guard lock(mutex);
      done += block->rows;
      if (progress) progress(done);
    }
    const std::lock_guard lock(mutex);
    add(all, counted);
  });
  failure.rethrow();
  // Adding 0 turns -0 into 0, so that the result does not depend on whether 0 or -0 came first.
  for (Box& box : all.boxes) box = {box.lo + Vec3{}, box.hi + Vec3{}};
  return all;
}

}  // namespace pointsweep
