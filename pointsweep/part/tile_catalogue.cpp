// SPDX-License-Identifier: MIT
#include "pointsweep/part/tile_catalogue.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {
namespace {

constexpr Encoding kCatalogueEncoding{"tiles", 1};
constexpr std::size_t kMostRegions = 16;  ///< most regions of a tile in the catalogue

TileRegion region_of(const TileIndex& tile, std::uint32_t first, std::uint32_t end) {
  TileRegion region{first, end, 0, {}, ~std::uint64_t{0}};
  for (std::uint32_t b = first; b < end; ++b) {
    region.count += tile.blocks[b].count;
    region.box.include(tile.blocks[b].box);
    region.least_row = std::min(region.least_row, tile.blocks[b].least_row);
  }
  return region;
}

/// Groups the blocks that are stored for other tiles into regions. If other tiles have to know all points, groups the
/// slabs instead.
std::vector<TileRegion> regions_of(const TileIndex& tile) {
  std::vector<std::uint32_t> ends;
  std::uint32_t begin = 0;
  if (tile.for_others) {
    begin = tile.own_blocks();
    for (std::uint32_t b = begin; b < tile.blocks.size(); ++b) ends.push_back(b + 1);
  } else {
    ends = tile.slab_ends;
  }
  std::vector<TileRegion> regions;
  const std::size_t each = (ends.size() + kMostRegions - 1) / kMostRegions;
  for (std::size_t e = 0; e < ends.size(); e += each) {
    const std::uint32_t end = ends[std::min(ends.size(), e + each) - 1];
    regions.push_back(region_of(tile, begin, end));
    begin = end;
  }
  return regions;
}

Vec3 center_of(const TileSummary& tile) {
  Box box;
  for (const TileRegion& region : tile.regions) box.include(region.box);
  return box.center();
}

std::uint64_t points_of(const TileSummary& tile) {
  std::uint64_t points = 0;
  for (const TileRegion& region : tile.regions) points += region.count;
  return points;
}

/// Divides tiles into groups by recursive halving across the longest side of the box of their centres.
class Grouper {
 public:
  explicit Grouper(const std::vector<TileSummary>& tiles) : tiles_(tiles) {
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t t = 0; t < tiles.size(); ++t) {
      centers_.push_back(center_of(tiles[t]));
      points_.push_back(points_of(tiles[t]));
      if (!tiles[t].regions.empty()) numbers.push_back(t);
    }
    if (!numbers.empty()) divide(numbers);
  }
  std::vector<TileGroup> take() { return std::move(groups_); }

 private:
  static constexpr std::size_t kMostTiles = 32;
  static constexpr std::uint64_t kMostPoints = 1 << 16;

  void divide(std::span<std::uint32_t> numbers) {
    std::uint64_t points = 0;
    Box centers;
    for (const std::uint32_t t : numbers) points += points_[t], centers.include(centers_[t]);
    if (numbers.size() == 1 || (numbers.size() <= kMostTiles && points <= kMostPoints)) return add(numbers, points);
    const Vec3 size = centers.hi - centers.lo;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = numbers.size() / 2;
    std::ranges::nth_element(numbers, numbers.begin() + static_cast<std::ptrdiff_t>(middle), {},
                             [&](std::uint32_t t) { return std::pair(centers_[t][axis], t); });
    divide(numbers.first(middle));
    divide(numbers.subspan(middle));
  }

  void add(std::span<const std::uint32_t> numbers, std::uint64_t points) {
    TileGroup group{{numbers.begin(), numbers.end()}, points, {}};
    std::ranges::sort(group.tiles);
    for (const std::uint32_t t : numbers)
      for (const TileRegion& region : tiles_[t].regions) group.box.include(region.box);
    groups_.push_back(std::move(group));
  }

  const std::vector<TileSummary>& tiles_;
  std::vector<Vec3> centers_;
  std::vector<std::uint64_t> points_;
  std::vector<TileGroup> groups_;
};

/// Returns the share of the volume of `box` that `other` covers, in [0, 1]. An axis along which `box` has no extent
/// counts as covered if the boxes touch along it.
double covered_share(const Box& box, const Box& other) {
  double share = 1;
  for (int a = 0; a < 3 && share > 0; ++a) {
    const double common = std::min(box.hi[a], other.hi[a]) - std::max(box.lo[a], other.lo[a]);
    const double length = box.hi[a] - box.lo[a];
    share *= common < 0 ? 0 : length > 0 ? common / length : 1;
  }
  return share;
}

}  // namespace

std::size_t TileCatalogue::tile_of(std::uint64_t row) const {
  const auto after = std::ranges::upper_bound(tiles, row, {}, &TileSummary::first_row);
  std::size_t tile = static_cast<std::size_t>(after - tiles.begin());
  do {
    if (tile-- == 0) fail("a tile names row {}, which no tile has.", row);
  } while (row - tiles[tile].first_row >= tiles[tile].rows);
  return tile;
}

void TileCatalogue::encode(Encoder& out) const {
  out.begin(kCatalogueEncoding);
  out.put_list(tiles, [&](const TileSummary& tile) {
    out.put_text(tile.name);
    out.put<std::uint64_t>(tile.first_row);
    out.put<std::uint64_t>(tile.rows);
    out.put_list(tile.regions, [&](const TileRegion& region) {
      out.put<std::uint32_t>(region.first_block);
      out.put<std::uint32_t>(region.end_block);
      out.put<std::uint64_t>(region.count);
      out.put_box(region.box);
      out.put<std::uint64_t>(region.least_row);
    });
  });
}

TileCatalogue TileCatalogue::decode(Decoder& in) {
  in.begin(kCatalogueEncoding);
  TileCatalogue catalogue;
  catalogue.tiles = in.get_list<TileSummary>([&] {
    TileSummary tile;
    tile.name = in.get_text();
    tile.first_row = in.get<std::uint64_t>();
    tile.rows = in.get<std::uint64_t>();
    tile.regions = in.get_list<TileRegion>([&] {
      TileRegion region;
      region.first_block = in.get<std::uint32_t>();
      region.end_block = in.get<std::uint32_t>();
      region.count = in.get<std::uint64_t>();
      region.box = in.get_box();
      region.least_row = in.get<std::uint64_t>();
      return region;
    });
    return tile;
  });
  catalogue.groups = Grouper(catalogue.tiles).take();
  return catalogue;
}

TileCatalogue catalogue_of(const Storage& scratch, const std::vector<std::string>& names,
                           const std::vector<std::string>& paths) {
  TileCatalogue catalogue;
  std::uint64_t rows = 0;
  std::string layout;
  std::size_t of_layout = 0;  // number of the first tile with a layout
  for (std::size_t t = 0; t < names.size(); ++t) {
    const TileIndex tile = tile_index(scratch, names[t]);
    if (layout.empty()) layout = tile.layout, of_layout = t;
    if (tile.rows > 0 && tile.layout != layout)
      fail(
          "{}: stores an attribute that the stages read in another type than {}; write all tiles with one run of "
          "'pointsweep convert' first.",
          paths[t], paths[of_layout]);
    catalogue.tiles.push_back({names[t], rows, tile.rows, regions_of(tile)});
    rows += tile.rows;
  }
  catalogue.groups = Grouper(catalogue.tiles).take();
  return catalogue;
}

std::shared_ptr<const TileCatalogue> shared_catalogue(const Storage& scratch, const std::string& key) {
  struct Kept {
    std::vector<std::byte> identity;
    std::shared_ptr<const TileCatalogue> catalogue;
  };
  static std::mutex mutex;
  static std::array<Kept, 2> kept;  // kept[0] was used last
  std::vector<std::byte> identity = sealed_identity(scratch, key);
  const std::scoped_lock lock(mutex);
  if (!identity.empty() && kept[1].identity == identity) std::swap(kept[0], kept[1]);
  if (identity.empty() || kept[0].identity != identity) {
    auto read = std::make_shared<const TileCatalogue>(sealed_value<TileCatalogue>(scratch, key));
    kept[1] = std::exchange(kept[0], {std::move(identity), std::move(read)});
  }
  return kept[0].catalogue;
}

double mean_tiles_of_a_point(std::span<const TileExtent> tiles) {
  double points = 0, covered = 0;
  for (const TileExtent& tile : tiles) {
    if (tile.box.empty()) continue;
    const auto n = static_cast<double>(tile.points);
    points += n;
    for (const TileExtent& other : tiles)
      if (!other.box.empty()) covered += n * covered_share(tile.box, other.box);
  }
  return points > 0 ? covered / points : 1;
}

void TileReader::read(std::span<const TileBlocks> all, std::span<std::byte> out) {
  for (const TileBlocks& blocks : all) {
    const Opened& tile = opened(blocks.tile);
    if (blocks.end > tile.index.blocks.size()) fail("{}.index: is of another run.", tiles_.tiles[blocks.tile].name);
    const std::uint64_t first = tile.first[blocks.first], count = tile.first[blocks.end] - first;
    const std::span<std::byte> records = out.first(count * record_bytes_);
    tile.points->read_at(first * record_bytes_, records);
    for (std::uint32_t b = blocks.first; b < blocks.end; ++b) {
      const std::size_t at = (tile.first[b] - first) * record_bytes_;
      require_whole(blocks.tile, records.subspan(at, tile.index.blocks[b].count * record_bytes_),
                    tile.index.blocks[b].checksum);
    }
    number(blocks.tile, records);
    out = out.subspan(records.size());
  }
}

void TileReader::read_nonfinite(std::size_t tile, std::uint64_t first, std::span<std::byte> out) {
  const Opened& from = opened(tile);
  const std::uint64_t end = first + out.size() / record_bytes_;
  std::vector<std::byte> piece;
  for (std::uint64_t p = first / kNonfiniteAtOnce; p * kNonfiniteAtOnce < end; ++p) {
    const std::uint64_t begin = p * kNonfiniteAtOnce;
    piece.resize(std::min(kNonfiniteAtOnce, from.index.nonfinite - begin) * record_bytes_);
    from.points->read_at((from.first.back() + begin) * record_bytes_, piece);
    require_whole(tile, piece, from.index.nonfinite_checksums[p]);
    const std::uint64_t from_row = std::max(first, begin), to_row = std::min(end, begin + kNonfiniteAtOnce);
    std::copy_n(piece.data() + (from_row - begin) * record_bytes_, (to_row - from_row) * record_bytes_,
                out.data() + (from_row - first) * record_bytes_);
  }
  number(tile, out);
}

const TileReader::Opened& TileReader::opened(std::size_t tile) {
  const std::scoped_lock lock(mutex_);
  std::unique_ptr<Opened>& place = opened_[tile];
  if (place) return *place;
  const std::string& name = tiles_.tiles[tile].name;
  auto found = std::make_unique<Opened>(Opened{tile_index(scratch_, name), scratch_.open(name + ".points"), {0}});
  for (const TileBlock& block : found->index.blocks) found->first.push_back(found->first.back() + block.count);
  const bool has_none = found->index.rows == 0;  // a tile without rows has no layout of records either
  if ((found->index.record_bytes != record_bytes_ && !has_none) || found->index.rows != tiles_.tiles[tile].rows)
    fail("{}.index: is of another run.", name);
  place = std::move(found);
  return *place;
}

void TileReader::require_whole(std::size_t tile, std::span<const std::byte> records, std::uint64_t checksum) const {
  if (checksum_of(records) != checksum) fail("{}.points: is damaged.", tiles_.tiles[tile].name);
}

/// Converts rows of the tile into rows of the cloud. The row is the last field of a record, as u64.
void TileReader::number(std::size_t tile, std::span<std::byte> records) const {
  std::byte* row_at = records.data() + record_bytes_ - sizeof(std::uint64_t);
  for (std::size_t i = 0; i < records.size() / record_bytes_; ++i, row_at += record_bytes_) {
    std::uint64_t row;
    std::memcpy(&row, row_at, sizeof row);
    row += tiles_.tiles[tile].first_row;
    std::memcpy(row_at, &row, sizeof row);
  }
}

}  // namespace pointsweep
