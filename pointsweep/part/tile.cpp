// SPDX-License-Identifier: MIT
#include "pointsweep/part/tile.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/points/record_map.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/search/cut.h"
#include "pointsweep/storage/storage.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr Encoding kTileEncoding{"tile", 4};
constexpr std::uint32_t kBlockPoints = 256;  ///< most points of a block

/// Converts records of a stream into the records that the scratch stores.
class ScratchRecord {
 public:
  explicit ScratchRecord(const Schema& working)
      : working_(working),
        position_(position_fields(working, "the working record")),
        schema_(schema_in_scratch(working)) {
    for (std::size_t f = kAxisNames.size(); f + 1 < schema_.fields.size(); ++f) {
      const Field& from = working.fields[*working.find(schema_.fields[f].name)];
      carried_.add(from.offset, schema_.fields[f].offset, size_of(from.type) * from.count);
    }
  }
  const Schema& schema() const { return schema_; }

  /// Writes the converted record of the stream record `from`, whose point is at `position`, to `to`. Returns the row of
  /// the point.
  std::uint64_t convert(const std::byte* from, const Vec3& position, std::byte* to) const {
    std::memcpy(to, &position, sizeof position);
    carried_.copy(from, to);
    const std::uint64_t row = row_of(working_, from);
    std::memcpy(to + schema_.fields.back().offset, &row, sizeof row);
    return row;
  }
  const PositionFields& position() const { return position_; }
  std::uint32_t working_bytes() const { return working_.stride; }

 private:
  const Schema& working_;
  PositionFields position_;
  Schema schema_;
  RecordMap carried_;
};

std::string layout_of(const Schema& schema) {
  std::string text;
  for (const Field& field : schema.fields)
    text += fmt::format("{} {} {} {} {} {} {};", field.name, static_cast<int>(field.type), field.count, field.bit_shift,
                        field.bit_width, field.scale, field.bias);
  return text;
}

std::vector<Vec3> positions_of(const ScratchRecord& record, std::span<const std::byte> records) {
  const std::size_t count = records.size() / record.working_bytes();
  std::vector<double> x(count), y(count), z(count);
  decode_positions(record.position(), records.data(), record.working_bytes(), count, x.data(), y.data(), z.data());
  std::vector<Vec3> places;
  places.reserve(count);
  for (std::size_t i = 0; i < count; ++i) places.push_back({x[i], y[i], z[i]});
  return places;
}

/// Some blocks, and their records in the order of the blocks.
struct StoredBlocks {
  std::vector<TileBlock> blocks;
  std::vector<std::byte> records;
};

/// Cuts the records of a slab whose indices are in `chosen` into blocks of points that lie close together.
StoredBlocks cut_into_blocks(const ScratchRecord& record, const Slab& slab, std::span<const std::byte> working,
                             const Schema& schema, const std::vector<std::uint32_t>& chosen) {
  const std::vector<Vec3> places = positions_of(record, working);
  const Vec3 middle = slab.box.center();
  std::vector<CutPoint> points;
  points.reserve(chosen.size());
  for (const std::uint32_t i : chosen) {
    const Vec3 p = places[i] - middle;
    points.push_back({{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}, i});
  }
  std::vector<std::uint32_t> begin;
  cut_into_cells(
      points, kBlockPoints, [&](std::uint32_t i) { return row_of(schema, working.data() + i * schema.stride); }, begin);
  StoredBlocks stored;
  stored.records.resize(chosen.size() * record.schema().stride);
  std::byte* to = stored.records.data();
  for (std::size_t b = 0; b + 1 < begin.size(); ++b) {
    TileBlock& block = stored.blocks.emplace_back();
    block.count = begin[b + 1] - begin[b];
    block.least_row = ~std::uint64_t{0};
    const std::byte* const first = to;
    for (std::uint32_t n = begin[b]; n < begin[b + 1]; ++n, to += record.schema().stride) {
      const std::uint32_t i = points[n].index;
      const std::uint64_t row = record.convert(working.data() + i * schema.stride, places[i], to);
      block.box.include(places[i]);
      block.least_row = std::min(block.least_row, row);
    }
    block.checksum = checksum_of({first, to});
  }
  return stored;
}

/// Stores the slabs of a tile. Copies of the points that other tiles have to know follow the slabs; the copies of a
/// slab stand together, in the order in which threads finish slabs.
class SlabsToTile {
 public:
  SlabsToTile(const Stream& stream, const ChooseForOthers& choose, Unsealed& points)
      : stream_(stream),
        choose_(choose),
        record_(stream.record_schema()),
        points_(points),
        own_(stream.slabs().size()) {
    for (const Slab& slab : stream.slabs()) end_ += slab.count;
  }

  void store() {
    parallel_for(own_.size(), [&](std::size_t s, unsigned) { store(s); });
  }
  void add_blocks_to(TileIndex& index) const {
    for (const std::vector<TileBlock>& of_slab : own_) {
      index.blocks.insert(index.blocks.end(), of_slab.begin(), of_slab.end());
      index.slab_ends.push_back(static_cast<std::uint32_t>(index.blocks.size()));
    }
    index.blocks.insert(index.blocks.end(), for_others_.begin(), for_others_.end());
    index.for_others = static_cast<bool>(choose_);
  }
  const ScratchRecord& record() const { return record_; }
  std::uint64_t end() const { return end_; }  ///< returns the number of records of all blocks

 private:
  void store(std::size_t s) {
    const Slab& slab = stream_.slabs()[s];
    const Schema& schema = stream_.record_schema();
    std::vector<std::byte> working(slab.count * schema.stride);
    stream_.read(s, working);
    std::vector<std::uint32_t> all(slab.count);
    std::iota(all.begin(), all.end(), 0u);
    StoredBlocks own = cut_into_blocks(record_, slab, working, schema, all);
    points_.write_at(slab.first * record_.schema().stride, own.records);
    own_[s] = std::move(own.blocks);
    if (!choose_) return;
    const StoredBlocks chosen = cut_into_blocks(record_, slab, working, schema, choose_(working));
    points_.write_at(place_for_others(chosen) * record_.schema().stride, chosen.records);
  }

  /// Adds blocks to `for_others_`, and returns the number of their first record in the object NAME.points.
  std::uint64_t place_for_others(const StoredBlocks& chosen) {
    const std::scoped_lock lock(mutex_);
    for_others_.insert(for_others_.end(), chosen.blocks.begin(), chosen.blocks.end());
    return std::exchange(end_, end_ + chosen.records.size() / record_.schema().stride);
  }

  const Stream& stream_;
  const ChooseForOthers& choose_;
  ScratchRecord record_;
  Unsealed& points_;
  std::vector<std::vector<TileBlock>> own_;  ///< blocks of each slab
  std::mutex mutex_;
  std::vector<TileBlock> for_others_;
  std::uint64_t end_ = 0;
};

/// Stores the points with non-finite coordinates after `first` other records. Returns TileIndex::nonfinite_checksums.
std::vector<std::uint64_t> store_nonfinite(const Stream& stream, const ScratchRecord& record, std::uint64_t first,
                                           Unsealed& points) {
  std::vector<std::uint64_t> checksums;
  for (std::uint64_t begin = 0; begin < stream.nonfinite_count(); begin += kNonfiniteAtOnce) {
    const std::uint64_t count = std::min(kNonfiniteAtOnce, stream.nonfinite_count() - begin);
    std::vector<std::byte> working(count * stream.record_schema().stride);
    stream.read_nonfinite(begin, working);
    const std::vector<Vec3> places = positions_of(record, working);
    std::vector<std::byte> made(count * record.schema().stride);
    for (std::size_t i = 0; i < count; ++i)
      record.convert(working.data() + i * record.working_bytes(), places[i], made.data() + i * record.schema().stride);
    checksums.push_back(checksum_of(made));
    points.write_at((first + begin) * record.schema().stride, made);
  }
  return checksums;
}

/// Returns the radius of a disc that holds k points at the density of the block, as if its points lay on a rectangle
/// with the two longest sides of its box.
double reach_in(const TileBlock& block, std::size_t k) {
  const Vec3 size = block.box.hi - block.box.lo;
  std::array<double, 3> side{size.x, size.y, size.z};
  std::ranges::sort(side);
  return std::sqrt(static_cast<double>(k) / static_cast<double>(block.count) * side[2] * side[1] / std::numbers::pi);
}

std::uint64_t points_of(const TileIndex& index, std::uint32_t blocks) {
  std::uint64_t points = 0;
  for (std::uint32_t b = 0; b < std::min<std::size_t>(blocks, index.blocks.size()); ++b)
    points += index.blocks[b].count;
  return points;
}

}  // namespace

Schema schema_in_scratch(const Schema& working) {
  Schema schema;
  for (const char* axis : kAxisNames) schema.append(axis, Type::f64);
  for (std::size_t f = 0; f + 1 < working.fields.size(); ++f) {
    Field field = working.fields[f];
    if (std::ranges::find(kAxisNames, field.name) != kAxisNames.end()) continue;
    schema.append(field.name, field.type, field.count);
    field.offset = schema.fields.back().offset;
    schema.fields.back() = field;
  }
  schema.append("row", Type::u64);
  return schema;
}

void TileIndex::encode(Encoder& out) const {
  out.begin(kTileEncoding);
  out.put_text(layout);
  out.put<std::uint32_t>(record_bytes);
  out.put<std::uint64_t>(rows);
  out.put<std::uint64_t>(nonfinite);
  out.put_numbers(std::span<const std::uint64_t>(nonfinite_checksums));
  survey.encode(out);
  out.put_list(blocks, [&](const TileBlock& block) {
    out.put<std::uint64_t>(block.count);
    out.put_box(block.box);
    out.put<std::uint64_t>(block.least_row);
    out.put<std::uint64_t>(block.checksum);
  });
  out.put_numbers(std::span<const std::uint32_t>(slab_ends));
  out.put<std::uint8_t>(for_others);
}

TileIndex TileIndex::decode(Decoder& in) {
  in.begin(kTileEncoding);
  TileIndex index;
  index.layout = in.get_text();
  index.record_bytes = in.get<std::uint32_t>();
  index.rows = in.get<std::uint64_t>();
  index.nonfinite = in.get<std::uint64_t>();
  index.nonfinite_checksums = in.get_numbers<std::uint64_t>();
  index.survey = Survey::decode(in);
  index.blocks = in.get_list<TileBlock>([&] {
    TileBlock block;
    block.count = in.get<std::uint64_t>();
    block.box = in.get_box();
    block.least_row = in.get<std::uint64_t>();
    block.checksum = in.get<std::uint64_t>();
    return block;
  });
  index.slab_ends = in.get_numbers<std::uint32_t>();
  index.for_others = in.get<std::uint8_t>() != 0;
  for (const TileBlock& block : index.blocks)
    if (block.count == 0 || block.count > kBlockPoints) fail("a block of a tile has {} points.", block.count);
  const std::uint32_t own = index.own_blocks();
  const bool are_all = index.for_others ? own <= index.blocks.size() : own == index.blocks.size();
  if (!are_all || !std::ranges::is_sorted(index.slab_ends) || index.nonfinite > index.rows ||
      points_of(index, own) != index.rows - index.nonfinite ||
      index.nonfinite_checksums.size() != index.nonfinite / kNonfiniteAtOnce + (index.nonfinite % kNonfiniteAtOnce > 0))
    fail("the blocks of a tile do not hold its {} rows.", index.rows);
  return index;
}

TileIndex store_tile(const Stream& stream, const Survey& survey, std::uint64_t rows, Storage& scratch,
                     const std::string& name, const ChooseForOthers& choose) {
  const std::unique_ptr<Unsealed> points = scratch.create(name + ".points");
  SlabsToTile slabs(stream, choose, *points);
  slabs.store();
  const ScratchRecord& record = slabs.record();
  TileIndex index;
  index.layout = layout_of(record.schema());
  index.record_bytes = record.schema().stride;
  index.rows = rows;
  index.nonfinite = stream.nonfinite_count();
  index.survey = survey;
  index.survey.sample.clear();
  slabs.add_blocks_to(index);
  index.nonfinite_checksums = store_nonfinite(stream, record, slabs.end(), *points);
  points->seal();
  seal_bytes(scratch, name + ".index", encoded(std::as_const(index)));
  return index;
}

void store_no_points(Storage& scratch, const std::string& name) {
  const TileIndex none;
  scratch.create(name + ".points")->seal();
  seal_bytes(scratch, name + ".index", encoded(none));
}

TileIndex tile_index(const Storage& scratch, const std::string& name) {
  return sealed_value<TileIndex>(scratch, name + ".index");
}

double expected_reach(const TileIndex& tile, const Neighborhood& what) {
  // In a tile of uneven density, the lists of most points end within this multiple of the median reach.
  constexpr double kAllowance = 4;
  if (what.k == Neighborhood::kUnlimited || tile.blocks.empty()) return what.radius;
  std::vector<double> reaches;
  for (const TileBlock& block : tile.blocks) reaches.push_back(reach_in(block, what.k));
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::ranges::nth_element(reaches, middle);
  return std::min(kAllowance * *middle, what.radius);
}

Box box_of_most(const TileIndex& tile) {
  Box most;
  if (tile.blocks.empty()) return most;
  const std::uint64_t spared = (tile.rows - tile.nonfinite) / 1000;
  for (int a = 0; a < 3; ++a) {
    const auto limit = [&](auto end_of, auto is_farther) {
      std::vector<const TileBlock*> blocks;
      for (const TileBlock& block : tile.blocks) blocks.push_back(&block);
      std::ranges::sort(blocks, is_farther, [&](const TileBlock* block) { return end_of(*block); });
      std::uint64_t left = spared;
      for (const TileBlock* block : blocks) {
        if (block->count > left) return end_of(*block);
        left -= block->count;
      }
      return 0.0;
    };
    most.lo[a] = limit([a](const TileBlock& b) { return b.box.lo[a]; }, std::less<>());
    most.hi[a] = limit([a](const TileBlock& b) { return b.box.hi[a]; }, std::greater<>());
  }
  return most;
}

}  // namespace pointsweep
