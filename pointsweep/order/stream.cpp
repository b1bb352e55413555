// SPDX-License-Identifier: MIT
#include "pointsweep/order/stream.h"

#include <algorithm>
#include <cassert>
#include <optional>

#include "pointsweep/order/distribution.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/order/split.h"
#include "pointsweep/order/splitters.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMostPieces = 4096;                           ///< dealt out at once
constexpr std::size_t kSamplesPerPiece = 16;                        ///< fewer make uneven slabs
constexpr std::size_t kLeastBlock = 8192, kLargestBlock = 1 << 20;  ///< bytes

/// Splitting does not stop at the axis, so a slab of one point is possible and one of none is not.
std::uint64_t most_points(const StreamOptions& options) {
  const std::uint64_t aim = std::max<std::uint64_t>(1, options.slab_points);
  return options.max_slab_points != 0 ? options.max_slab_points : 2 * aim;
}

std::size_t most_pieces(const StreamOptions& options) {
  return std::clamp<std::size_t>(options.buffer_bytes / 2 / kLeastBlock, 2, kMostPieces);
}

/// In memory, blocks are small against a slab, so that little of the last one is wasted; spilling, as large as the
/// buffers allow, so that the disk writes long pieces.
std::size_t block_bytes(const StreamOptions& options, std::size_t pieces, std::size_t record_bytes) {
  if (!options.spill)
    return std::clamp<std::size_t>(options.slab_points * record_bytes / 16, kLeastBlock / 2, kLargestBlock / 4);
  return std::clamp<std::size_t>(options.buffer_bytes / 2 / (pieces + 1), kLeastBlock, kLargestBlock);
}

Splitters first_splitters(std::uint64_t points, const Survey& survey, const LocalSpacing& spacing,
                          const StreamOptions& options) {
  std::vector<double> sample;
  for (const Vec3& p : survey.sample) sample.push_back(p[options.axis]);
  const std::vector<double> coordinates = sample;
  const std::uint64_t wanted = points / std::max<std::uint64_t>(1, options.slab_points) + 1;
  const std::size_t pieces =
      std::min<std::uint64_t>({wanted, most_pieces(options), sample.size() / kSamplesPerPiece + 1});
  std::vector<double> limits = quantile_limits(sample, pieces);
  if (!options.canonical) limits = limits_not_too_near(limits, coordinates, spacing.at_sample());
  return Splitters(limits);
}

struct PiecedSlab {
  Slab slab;
  std::vector<StreamPiece> pieces;
};

}  // namespace

struct Stream::State {
  State(const PointSource& source, const StreamOptions& options)
      : record(source.schema, options.whole_records, options.payload, source.count) {
    split.axis = options.axis;
    split.most = most_points(options);
    split.aim = std::clamp<std::uint64_t>(options.slab_points, 1, split.most);
    split.most_pieces = most_pieces(options);
    split.buffer_bytes = options.buffer_bytes / 4;
    split.canonical = options.canonical;
  }

  /// Reads the source once and returns the pieces it is cut into.
  std::vector<StreamPiece> deal_out(const PointSource& source, const Splitters& splitters,
                                    const StreamOptions& options) {
    const std::size_t count = splitters.pieces(), record_bytes = record.schema().stride;
    store.emplace(count + 1, record_bytes, block_bytes(options, count, record_bytes), options.spill);
    nonfinite_list = count;
    const auto read = [&](std::uint64_t row, std::span<std::byte> records) {
      read_fully(source, row, records);
      if (options.progress) options.progress(row + records.size() / source.schema.stride);
    };
    const std::vector<Box> boxes = distribute({.schema = source.schema,
                                               .count = source.count,
                                               .read = read,
                                               .record = record,
                                               .key = static_cast<SortKey>(options.axis),
                                               .splitters = splitters,
                                               .first_list = 0,
                                               .nonfinite_list = nonfinite_list,
                                               .memory_bytes = options.buffer_bytes / 4},
                                              *store);
    store->finish();
    std::vector<StreamPiece> dealt;
    for (std::size_t p = 0; p < count; ++p) dealt.push_back({p, store->count(p), boxes[p]});
    return dealt;
  }

  /// Joins neighbouring pieces that are small together: a thin slab gives slivers. Copies of one point stay by
  /// themselves, so that they need not wait for slabs around them.
  void join(const std::vector<StreamPiece>& pieces) {
    std::uint64_t first = 0;
    bool after_copies = false;
    for (const StreamPiece& piece : pieces) {
      const bool copies = piece.count > 1 && piece.box.lo == piece.box.hi;
      if (slabs.empty() || copies || after_copies || slabs.back().slab.count + piece.count > split.aim) {
        slabs.push_back({{first, 0, {}, piece.least_row}, {}});
      }
      after_copies = copies;
      slabs.back().slab.count += piece.count;
      slabs.back().slab.least_row = std::min(slabs.back().slab.least_row, piece.least_row);
      slabs.back().slab.box.include(piece.box);
      slabs.back().pieces.push_back(piece);
      first += piece.count;
    }
  }

  void sort_nonfinite() {
    SplitOptions by_row = split;
    by_row.canonical = true;
    by_row.most = by_row.aim = std::max<std::uint64_t>(1, split.buffer_bytes / 2 / record.schema().stride);
    nonfinite_list = sort_list_by_row(nonfinite_list, record.schema(), by_row, *store);
  }

  WorkingRecord record;
  SplitOptions split;
  std::optional<SlabStore> store;
  std::vector<PiecedSlab> slabs;
  std::size_t nonfinite_list = 0;
};

Stream::Stream(const PointSource& source, const Survey& survey, const StreamOptions& options)
    : axis_(options.axis), state_(std::make_unique<State>(source, options)) {
  State& s = *state_;
  record_schema_ = s.record.schema();
  spacing_ = LocalSpacing(survey.sample, source.count, survey.dimension);
  const std::vector<StreamPiece> dealt =
      s.deal_out(source, first_splitters(source.count, survey, spacing_, options), options);
  s.join(split_large_pieces(dealt, record_schema_, s.split, *s.store));
  for (const PiecedSlab& slab : s.slabs) slabs_.push_back(slab.slab);
  nonfinite_count_ = s.store->count(s.nonfinite_list);
  s.sort_nonfinite();
}

Stream::Stream(Unpacker& packed, const PointSource& source, const StreamOptions& options)
    : axis_(packed.get<int>()), spacing_(packed), state_(std::make_unique<State>(source, options)) {
  State& s = *state_;
  record_schema_ = s.record.schema();
  s.slabs.resize(packed.get<std::uint64_t>());
  for (PiecedSlab& slab : s.slabs) {
    slab = {packed.get<Slab>(), packed.get_vector<StreamPiece>()};
    slabs_.push_back(slab.slab);
  }
  s.nonfinite_list = packed.get<std::uint64_t>();
  s.store.emplace(packed, record_schema_.stride, kLeastBlock, options.spill);
  nonfinite_count_ = s.store->count(s.nonfinite_list);
}

Stream::~Stream() = default;

void Stream::pack(Packer& out) const {
  out.put(axis_);
  spacing_.pack(out);
  out.put<std::uint64_t>(state_->slabs.size());
  for (const PiecedSlab& slab : state_->slabs) {
    out.put(slab.slab);
    out.put(slab.pieces);
  }
  out.put<std::uint64_t>(state_->nonfinite_list);
  state_->store->pack(out);
}

std::uint64_t Stream::spilled_bytes() const { return state_->store->spilled_bytes(); }
std::uint64_t Stream::memory_bytes() const { return state_->store->memory_bytes(); }

void Stream::read(std::size_t slab, std::span<std::byte> out) const {
  const State& s = *state_;
  assert(out.size() == slabs_[slab].count * record_schema_.stride);
  for (const StreamPiece& piece : s.slabs[slab].pieces) {
    const std::size_t bytes = piece.count * record_schema_.stride;
    s.store->read(piece.list, 0, out.first(bytes));
    out = out.subspan(bytes);
  }
}

void Stream::read_nonfinite(std::uint64_t first, std::span<std::byte> out) const {
  state_->store->read(state_->nonfinite_list, first, out);
}

}  // namespace pointsweep
