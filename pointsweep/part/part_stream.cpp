// SPDX-License-Identifier: MIT
#include "pointsweep/part/part_stream.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/math/box.h"

namespace pointsweep {
namespace {

/// The halo of a part is halved in width while it has more points than kSmallHalo and more than half as many as the
/// tile. It is halved at most kMostTries times, because a tile that overlaps other tiles has a large halo at any width.
constexpr std::uint64_t kSmallHalo = 1000;
constexpr int kMostTries = 6;

/// The ranges of blocks that make one slab of a part, as a segment of a list that all slabs share. One list takes less
/// memory than a list for each slab.
struct BlocksOfSlab {
  std::size_t first, count;
};

/// Divides a cloud for the sweep of one tile: into slabs near the tile (its own and its halo), which the sweep reads,
/// and slabs far from the tile, which only the recall reads.
class PartCutter {
 public:
  PartCutter(TileReader& reader, const TileCatalogue& tiles, std::size_t own)
      : reader_(reader), tiles_(tiles), own_(static_cast<std::uint32_t>(own)) {}

  void cut(double reach) {
    const TileIndex& tile = reader_.index(own_);
    own_points_ = tile.rows - tile.nonfinite;
    const Box known = box_of_most(tile);
    reach = std::min(reach, known.diagonal());
    for (int tries = 0;; ++tries, reach /= 2) {
      near_ = far_ = {};
      blocks_.clear();
      swept_points_ = own_points_;
      look_around(grown(known, reach), grown(known, reach + known.diagonal()));
      if (tries == kMostTries || halo_points() <= std::max(kSmallHalo, own_points_ / 2)) break;
    }
    for (std::uint32_t s = 0; s < tile.slab_ends.size(); ++s) add(near_, own_, {slab_of(own_, s)});
    const int axis = tile.survey.axis;
    const auto begin = [axis](const auto& slab) { return slab.first.box.lo[axis]; };
    std::ranges::stable_sort(near_, {}, begin);
    std::ranges::stable_sort(far_, {}, begin);
  }

  using SlabOfBlocks = std::pair<Slab, BlocksOfSlab>;
  std::vector<SlabOfBlocks> take_near() { return std::move(near_); }
  std::vector<SlabOfBlocks> take_far() { return std::move(far_); }
  std::vector<TileBlocks> take_blocks() { return std::move(blocks_); }
  std::uint64_t own_points() const { return own_points_; }
  std::uint64_t swept_points() const { return swept_points_; }

 private:
  std::uint64_t halo_points() const { return swept_points_ - own_points_; }

  static Box grown(const Box& box, double reach) {
    if (box.empty()) return box;
    return {{box.lo.x - reach, box.lo.y - reach, -Box::kInf}, {box.hi.x + reach, box.hi.y + reach, Box::kInf}};
  }
  static bool touch(const Box& a, const Box& b) { return !a.empty() && !b.empty() && distance2(a, b) == 0; }

  TileBlocks slab_of(std::uint32_t t, std::uint32_t slab) {
    const std::vector<std::uint32_t>& ends = reader_.index(t).slab_ends;
    return {t, slab == 0 ? 0 : ends[slab - 1], ends[slab]};
  }

  /// Divides the blocks of the other tiles into blocks that touch the box `known` and blocks that do not. A group of
  /// tiles that does not touch the box `around` makes one slab. Of a nearer tile whose regions do not touch `known`,
  /// each region makes one slab.
  void look_around(const Box& known, const Box& around) {
    for (const TileGroup& group : tiles_.groups) {
      if (!touch(around, group.box)) {
        add_far(group);
        continue;
      }
      for (const std::uint32_t t : group.tiles) {
        if (t == own_) continue;
        const std::vector<TileRegion>& regions = tiles_.tiles[t].regions;
        if (std::ranges::any_of(regions, [&](const TileRegion& r) { return touch(known, r.box); }))
          divide(t, known);
        else
          for (const TileRegion& region : regions) add_far(t, region);
      }
    }
  }

  void divide(std::uint32_t t, const Box& known) {
    const TileIndex& tile = reader_.index(t);
    for (std::uint32_t s = 0; s < tile.slab_ends.size(); ++s) {
      std::vector<TileBlocks> near, far;
      const TileBlocks slab = slab_of(t, s);
      for (std::uint32_t b = slab.first; b < slab.end; ++b) {
        const bool touches = touch(known, tile.blocks[b].box);
        if (touches) swept_points_ += tile.blocks[b].count;
        std::vector<TileBlocks>& to = touches ? near : far;
        if (!to.empty() && to.back().end == b)
          ++to.back().end;
        else
          to.push_back({t, b, b + 1});
      }
      add(near_, t, near);
      add(far_, t, far);
    }
  }

  void add_far(std::uint32_t t, const TileRegion& region) {
    const Slab slab{0, region.count, region.box, tiles_.tiles[t].first_row + region.least_row, true};
    far_.emplace_back(slab, BlocksOfSlab{blocks_.size(), 1});
    blocks_.push_back({t, region.first_block, region.end_block});
  }

  void add_far(const TileGroup& group) {
    Slab slab{0, group.count, group.box, ~std::uint64_t{0}, true};
    const std::size_t first = blocks_.size();
    for (const std::uint32_t t : group.tiles) {
      for (const TileRegion& region : tiles_.tiles[t].regions) {
        slab.least_row = std::min(slab.least_row, tiles_.tiles[t].first_row + region.least_row);
        blocks_.push_back({t, region.first_block, region.end_block});
      }
    }
    far_.emplace_back(slab, BlocksOfSlab{first, blocks_.size() - first});
  }

  void add(std::vector<SlabOfBlocks>& to, std::uint32_t t, const std::vector<TileBlocks>& of_slab) {
    if (of_slab.empty()) return;
    const TileIndex& tile = reader_.index(t);
    Slab slab;
    slab.least_row = ~std::uint64_t{0};
    slab.is_halo = t != own_;
    for (const TileBlocks& range : of_slab) {
      for (std::uint32_t b = range.first; b < range.end; ++b) {
        slab.count += tile.blocks[b].count;
        slab.box.include(tile.blocks[b].box);
        slab.least_row = std::min(slab.least_row, tiles_.tiles[t].first_row + tile.blocks[b].least_row);
      }
    }
    to.emplace_back(slab, BlocksOfSlab{blocks_.size(), of_slab.size()});
    blocks_.insert(blocks_.end(), of_slab.begin(), of_slab.end());
  }

  TileReader& reader_;
  const TileCatalogue& tiles_;
  std::uint32_t own_;
  std::uint64_t own_points_ = 0, swept_points_ = 0;
  std::vector<SlabOfBlocks> near_, far_;
  std::vector<TileBlocks> blocks_;  ///< blocks of all slabs
};

}  // namespace

PartStream part_stream(const Storage& scratch, const TileCatalogue& tiles, std::size_t number, const Schema& working,
                       const Neighborhood& what, std::size_t steps) {
  Schema schema = schema_in_scratch(working);
  const auto reader = std::make_shared<TileReader>(scratch, tiles, schema.stride);
  const TileIndex& own = reader->index(number);
  PartCutter cutter(*reader, tiles, number);
  cutter.cut(expected_reach(own, what) * static_cast<double>(steps));
  StoredSlabs stored;
  stored.axis = own.survey.axis;
  stored.record_schema = std::move(schema);
  stored.nonfinite_count = own.nonfinite;
  const auto of_slabs = std::make_shared<std::vector<BlocksOfSlab>>();
  std::uint64_t first = 0;
  const auto add = [&](std::vector<PartCutter::SlabOfBlocks> slabs) {
    for (auto& [slab, of_slab] : slabs) {
      slab.first = std::exchange(first, first + slab.count);
      stored.slabs.push_back(slab);
      of_slabs->push_back(of_slab);
    }
  };
  add(cutter.take_near());
  stored.swept_slabs = stored.slabs.size();
  add(cutter.take_far());
  const auto blocks = std::make_shared<const std::vector<TileBlocks>>(cutter.take_blocks());
  stored.read = [reader, of_slabs, blocks](std::size_t slab, std::span<std::byte> out) {
    const BlocksOfSlab& of_slab = (*of_slabs)[slab];
    reader->read(std::span(*blocks).subspan(of_slab.first, of_slab.count), out);
  };
  stored.read_nonfinite = [reader, number](std::uint64_t first_record, std::span<std::byte> out) {
    reader->read_nonfinite(number, first_record, out);
  };
  return {.stream = Stream(std::move(stored)),
          .survey = own.survey,
          .first_row = tiles.tiles[number].first_row,
          .own_points = cutter.own_points(),
          .swept_points = cutter.swept_points()};
}

}  // namespace pointsweep
