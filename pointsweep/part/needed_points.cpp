// SPDX-License-Identifier: MIT
#include "pointsweep/part/needed_points.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/math/box_tree.h"

namespace pointsweep {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();

/// Returns the squared distance between the farthest points of two boxes. No distance2() of a point in `a` and a point
/// in `b` exceeds it.
double most_distance2(const Box& a, const Box& b) {
  const auto along = [&](int axis) { return std::max(a.hi[axis] - b.lo[axis], b.hi[axis] - a.lo[axis]); };
  const double dx = along(0), dy = along(1), dz = along(2);
  return (dx * dx + dy * dy) + dz * dz;
}

/// Successive blocks of a tile whose points an operator may have to know.
struct Candidate {
  Box box;
  std::uint64_t count;
  std::uint32_t tile;
  std::uint32_t first_block, end_block;
};

/// Finds the candidates that may hold points on which the results of given points depend.
class Chooser {
 public:
  Chooser(const InOrderOperator& op, Reach reach) : op_(op), reach_(reach) {
    in_plane_ = op.in_order_contract().places == Places::in_plane;
  }

  /// Converts a box of positions into the space in which the operator compares points. An operator that looks for
  /// nearest points compares positions, with z = 0 if it works in the plane. Other operators compare the
  /// places that place_of() gives, which ascend with positions.
  Box compared(const Box& box) const {
    if (box.empty()) return box;
    if (reach_.nearest == 0) return {op_.place_of(box.lo), op_.place_of(box.hi)};
    return in_plane_ ? Box{{box.lo.x, box.lo.y, 0}, {box.hi.x, box.hi.y, 0}} : box;
  }

  /// Returns for each candidate whether points in any of `boxes` need it. All boxes come from compared(). Fastest if
  /// successive boxes lie close together.
  std::vector<bool> needed(const std::vector<Box>& boxes, const std::vector<Candidate>& candidates) const {
    std::vector<bool> chosen(candidates.size());
    std::vector<std::size_t> all(candidates.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    if (!boxes.empty()) choose(boxes, 0, boxes.size(), candidates, std::move(all), chosen);
    return chosen;
  }

 private:
  void choose(const std::vector<Box>& boxes, std::size_t begin, std::size_t end,
              const std::vector<Candidate>& candidates, std::vector<std::size_t> left,
              std::vector<bool>& chosen) const {
    Box around;
    for (std::size_t b = begin; b < end; ++b) around.include(boxes[b]);
    const double most2 = most_distance2_of_nearest(around, candidates, left);
    std::erase_if(left, [&](std::size_t i) { return !may_matter(around, candidates[i].box, most2); });
    if (end - begin == 1) {
      for (const std::size_t i : left) chosen[i] = true;
      return;
    }
    const auto is_chosen = [&](std::size_t i) { return chosen[i]; };
    if (reach_.nearest == 0) std::erase_if(left, is_chosen);
    if (std::ranges::all_of(left, is_chosen)) return;
    const std::size_t middle = begin + (end - begin) / 2;
    choose(boxes, begin, middle, candidates, left, chosen);
    choose(boxes, middle, end, candidates, std::move(left), chosen);
  }

  /// Returns the square of a distance, at most Reach::distance, within which all nearest points lie that the operator
  /// needs for any point of the box. Returns infinity if the operator does not look for nearest points.
  double most_distance2_of_nearest(const Box& box, const std::vector<Candidate>& candidates,
                                   const std::vector<std::size_t>& left) const {
    if (reach_.nearest == 0) return kEverywhere;
    std::vector<std::pair<double, std::uint64_t>> within;
    for (const std::size_t i : left) within.emplace_back(most_distance2(box, candidates[i].box), candidates[i].count);
    std::ranges::sort(within);
    std::uint64_t points = 0;
    for (const auto& [distance2, count] : within)
      if ((points += count) >= reach_.nearest) return std::min(distance2, reach_.distance * reach_.distance);
    return reach_.distance * reach_.distance;
  }

  bool may_matter(const Box& box, const Box& other, double most2) const {
    if (reach_.nearest > 0) return distance2(box, other) <= most2;
    for (int a = 0; a < (in_plane_ ? 2 : 3); ++a)
      if (box.lo[a] - other.hi[a] > reach_.distance || other.lo[a] - box.hi[a] > reach_.distance) return false;
    return true;
  }

  const InOrderOperator& op_;
  Reach reach_;
  bool in_plane_;
};

/// The records of chosen blocks of tiles, numbered one after another.
class BlockSource {
 public:
  BlockSource(std::shared_ptr<TileReader> reader, const Schema& schema) : reader_(std::move(reader)), schema_(schema) {}

  void add(const TileBlocks& blocks) {
    const std::uint64_t points =
        reader_->points_before(blocks.tile, blocks.end) - reader_->points_before(blocks.tile, blocks.first);
    if (points == 0) return;
    pieces_.push_back({blocks, count_});
    count_ += points;
  }
  void add_nonfinite(std::uint32_t tile) {
    pieces_.push_back({{tile, 0, 0}, count_});
    count_ += reader_->index(tile).nonfinite;
  }
  std::uint64_t count() const { return count_; }

  /// Fills `records` with records from number `row` on, perhaps fewer than fit, and returns their number. `block` is a
  /// buffer that later calls use again.
  std::size_t read(std::uint64_t row, std::span<std::byte> records, std::vector<std::byte>& block) const {
    const auto after = std::ranges::upper_bound(pieces_, row, {}, &Piece::first);
    const Piece& piece = *std::prev(after);
    const std::uint64_t in_piece = row - piece.first, stride = schema_.stride;
    if (piece.blocks.end == 0) {  // points with non-finite coordinates
      const std::uint64_t end = after == pieces_.end() ? count_ : after->first;
      const std::size_t n = std::min<std::uint64_t>(records.size() / stride, end - row);
      reader_->read_nonfinite(piece.blocks.tile, in_piece, records.first(n * stride));
      return n;
    }
    return read_blocks(piece, in_piece, records, block);
  }

 private:
  struct Piece {
    TileBlocks blocks;    ///< an empty range stands for the points with non-finite coordinates
    std::uint64_t first;  ///< number of the first record of the piece among the records of all pieces
  };

  /// Reads as many whole blocks as fit into `records`; if no block fits or `from` lies inside a block, reads a part of
  /// one block.
  std::size_t read_blocks(const Piece& piece, std::uint64_t from, std::span<std::byte> records,
                          std::vector<std::byte>& block) const {
    const std::size_t stride = schema_.stride, wanted = records.size() / stride;
    const auto before = [&](std::uint32_t b) {
      return reader_->points_before(piece.blocks.tile, b) -
             reader_->points_before(piece.blocks.tile, piece.blocks.first);
    };
    std::uint32_t low = piece.blocks.first, high = piece.blocks.end;  // the block of `from` is in [low, high)
    while (high - low > 1) {
      const std::uint32_t middle = low + (high - low) / 2;
      (before(middle) <= from ? low : high) = middle;
    }
    std::uint32_t end = low;
    if (before(low) == from)
      while (end < piece.blocks.end && before(end + 1) - from <= wanted) ++end;
    if (end > low) {
      const std::size_t n = before(end) - from;
      const TileBlocks whole{piece.blocks.tile, low, end};
      reader_->read(std::span(&whole, 1), records.first(n * stride));
      return n;
    }
    block.resize((before(low + 1) - before(low)) * stride);
    const TileBlocks one{piece.blocks.tile, low, low + 1};
    reader_->read(std::span(&one, 1), block);
    const std::size_t skipped = from - before(low), n = std::min(wanted, block.size() / stride - skipped);
    std::copy_n(block.begin() + static_cast<std::ptrdiff_t>(skipped * stride), n * stride, records.begin());
    return n;
  }

  std::shared_ptr<TileReader> reader_;
  Schema schema_;
  std::vector<Piece> pieces_;
  std::uint64_t count_ = 0;
};

PointSource source_of(const std::shared_ptr<const BlockSource>& blocks, const Schema& schema) {
  const auto reading = [blocks]() -> ReadRows {
    return [blocks, block = std::vector<std::byte>()](std::uint64_t row, std::span<std::byte> records) mutable {
      return blocks->read(row, records, block);
    };
  };
  return {.schema = schema,
          .count = blocks->count(),
          .read = reading(),
          .for_thread = [reading](const std::vector<std::size_t>&) { return reading(); }};
}

std::vector<Box> own_boxes(const TileIndex& tile, const Chooser& chooser) {
  std::vector<Box> boxes;
  for (std::uint32_t b = 0; b < tile.own_blocks(); ++b) boxes.push_back(chooser.compared(tile.blocks[b].box));
  return boxes;
}

/// Returns the blocks that points in the boxes `own` need, in the order of their tiles. Regions of blocks are tested
/// first, then the blocks of the needed regions.
std::vector<Candidate> needed_blocks(TileReader& reader, const TileCatalogue& tiles, const std::vector<Box>& own,
                                     const Chooser& chooser) {
  const auto only_needed = [&](std::vector<Candidate> candidates) {
    const std::vector<bool> needed = chooser.needed(own, candidates);
    std::size_t i = 0;
    std::erase_if(candidates, [&](const Candidate&) { return !needed[i++]; });
    return candidates;
  };
  std::vector<Candidate> regions, blocks;
  for (std::uint32_t t = 0; t < tiles.tiles.size(); ++t)
    for (const TileRegion& r : tiles.tiles[t].regions)
      regions.push_back({chooser.compared(r.box), r.count, t, r.first_block, r.end_block});
  for (const Candidate& region : only_needed(std::move(regions))) {
    const TileIndex& tile = reader.index(region.tile);
    if (region.end_block > tile.blocks.size()) fail("{}.index: is of another run.", tiles.tiles[region.tile].name);
    for (std::uint32_t b = region.first_block; b < region.end_block; ++b)
      blocks.push_back({chooser.compared(tile.blocks[b].box), tile.blocks[b].count, region.tile, b, b + 1});
  }
  return only_needed(std::move(blocks));
}

/// Returns the function for NeededPoints::may_lack, if all blocks within `reach` of the boxes of the tile are present.
/// It uses the triangle inequality, with a factor for rounding.
std::function<bool(Vec3, double)> beyond(const TileIndex& own, double reach) {
  std::vector<Box> boxes;
  for (std::uint32_t b = 0; b < own.own_blocks(); ++b) boxes.push_back(own.blocks[b].box);
  return [tree = BoxTree(std::move(boxes)), reach](Vec3 position, double distance) {
    const double left = (reach - distance) * (1 - 1e-9);
    return !(left > 0 && tree.any_within(position, left * left, [](std::size_t) { return true; }));
  };
}

std::uint64_t points_in(const TileCatalogue& tiles) {
  std::uint64_t points = 0;
  for (const TileGroup& group : tiles.groups) points += group.count;
  return points;
}

/// Returns one block of any tile; nothing if no tile has a block.
std::vector<Candidate> any_block(const TileCatalogue& tiles) {
  for (std::uint32_t t = 0; t < tiles.tiles.size(); ++t)
    for (const TileRegion& r : tiles.tiles[t].regions) return {{r.box, 0, t, r.first_block, r.first_block + 1}};
  return {};
}

/// Adds blocks to a source. Successive blocks of a tile become one piece.
void add_blocks(BlockSource& source, const std::vector<Candidate>& blocks) {
  for (std::size_t i = 0, end = 0; i < blocks.size(); i = end) {
    end = i + 1;
    while (end < blocks.size() && blocks[end].tile == blocks[i].tile &&
           blocks[end].first_block == blocks[end - 1].end_block)
      ++end;
    source.add({blocks[i].tile, blocks[i].first_block, blocks[end - 1].end_block});
  }
}

}  // namespace

NeededPoints needed_points(const Storage& scratch, const TileCatalogue& tiles, std::size_t number,
                           const Schema& working, const InOrderOperator& op, const Reach& reach) {
  const Schema schema = schema_in_scratch(working);
  const auto reader = std::make_shared<TileReader>(scratch, tiles, schema.stride);
  const auto source = std::make_shared<BlockSource>(reader, schema);
  const TileIndex& own = reader->index(number);
  const Chooser chooser(op, reach);
  const auto own_number = static_cast<std::uint32_t>(number);
  source->add({own_number, 0, own.own_blocks()});
  std::vector<Candidate> blocks = needed_blocks(*reader, tiles, own_boxes(own, chooser), chooser);
  std::erase_if(blocks, [&](const Candidate& block) { return block.tile == number; });
  add_blocks(*source, blocks);
  const std::uint64_t points = source->count();
  if (own.nonfinite > 0) source->add_nonfinite(own_number);
  NeededPoints needed{source_of(source, schema), tiles.tiles[number].first_row, own.rows - own.nonfinite, points};
  if (reach.is_guess && points < points_in(tiles)) needed.may_lack = beyond(own, reach.distance);
  return needed;
}

NeededPoints needed_of_other(const Storage& scratch, const TileCatalogue& tiles, std::size_t number,
                             const TileCatalogue& other, const Schema& working, const InOrderOperator& op) {
  const Schema schema = schema_in_scratch(working);
  const TileIndex own = tile_index(scratch, tiles.tiles[number].name);
  const auto reader = std::make_shared<TileReader>(scratch, other, schema.stride);
  const auto source = std::make_shared<BlockSource>(reader, schema);
  const Chooser chooser(op, op.other_reach().value());
  std::vector<Candidate> blocks = needed_blocks(*reader, other, own_boxes(own, chooser), chooser);
  if (blocks.empty()) blocks = any_block(other);  // operators refuse another cloud without points
  add_blocks(*source, blocks);
  return {source_of(source, schema), 0, 0, source->count()};
}

}  // namespace pointsweep
