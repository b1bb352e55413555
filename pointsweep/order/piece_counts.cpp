// SPDX-License-Identifier: MIT
#include "pointsweep/order/piece_counts.h"

#include <algorithm>
#include <mutex>

#include "pointsweep/cancellation.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

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
  // Adding 0 turns -0 into 0, so that the result does not depend on which of them came first.
  for (Box& box : all.boxes) box = {box.lo + Vec3{}, box.hi + Vec3{}};
  return all;
}

}  // namespace pointsweep
