// SPDX-License-Identifier: MIT
#include "pointsweep/order/stream.h"

#include <algorithm>
#include <cassert>
#include <optional>

#include "pointsweep/error.h"
#include "pointsweep/order/distribution.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/order/split.h"
#include "pointsweep/order/splitters.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMostPieces = 4096;                        ///< dealt out at once
constexpr std::size_t kSamplesPerPiece = 16;                     ///< fewer make uneven slabs
constexpr std::size_t kLeastBlock = 8192, kLargestBlock = 1 << 20;  ///< bytes

/// Splitting does not stop at the axis, so a slab of one point is possible and one of none is not.
std::uint64_t most_points(const StreamOptions& options) {
  const std::uint64_t aim = std::max<std::uint64_t>(1, options.slab_points);
  return options.max_slab_points != 0 ? options.max_slab_points : 4 * aim;
}

std::size_t most_pieces(const StreamOptions& options) {
  return std::clamp<std::size_t>(options.buffer_bytes / 2 / kLeastBlock, 2, kMostPieces);
}

/// In memory, blocks are small against a slab, so that little of the last one is wasted; spilling, as large as the
/// buffers allow, so that the disk writes long pieces.
std::size_t block_bytes(const StreamOptions& options, std::size_t pieces, std::size_t record_bytes) {
  if (options.spill == nullptr)
    return std::clamp<std::size_t>(options.slab_points * record_bytes / 16, kLeastBlock / 2, kLargestBlock / 4);
  return std::clamp<std::size_t>(options.buffer_bytes / 2 / (pieces + 1), kLeastBlock, kLargestBlock);
}

Splitters first_splitters(std::uint64_t points, const Survey& survey, const StreamOptions& options) {
  std::vector<double> sample;
  for (const Vec3& p : survey.sample) sample.push_back(p[options.axis]);
  const std::uint64_t wanted = points / std::max<std::uint64_t>(1, options.slab_points) + 1;
  const std::size_t pieces = std::min<std::uint64_t>({wanted, most_pieces(options), sample.size() / kSamplesPerPiece + 1});
  return Splitters(quantile_limits(sample, pieces));
}

}  // namespace

struct Stream::State {
  explicit State(WorkingRecord made) : record(std::move(made)) {}

  /// Joins neighbouring pieces that are small together: a thin slab gives slivers.
  std::vector<Slab> join_pieces(std::vector<StreamPiece> all, std::uint64_t aim) {
    std::vector<Slab> slabs;
    std::uint64_t first = 0;
    pieces = std::move(all);
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      if (slabs.empty() || slabs.back().count + pieces[p].count > aim) {
        slabs.push_back({first, 0, {}});
        first_piece.push_back(p);
      }
      slabs.back().count += pieces[p].count;
      slabs.back().box.include(pieces[p].box);
      first += pieces[p].count;
    }
    first_piece.push_back(pieces.size());
    return slabs;
  }

  WorkingRecord record;
  std::optional<SlabStore> store;
  std::vector<StreamPiece> pieces;        ///< in the order of the stream
  std::vector<std::size_t> first_piece;  ///< by slab; one more at the end
  std::size_t nonfinite_list = 0;
};

Stream::Stream(const PointSource& source, const Survey& survey, const StreamOptions& options)
    : axis_(options.axis),
      state_(std::make_unique<State>(
          WorkingRecord(source.schema, options.whole_records, options.payload, source.count))) {
  State& s = *state_;
  record_schema_ = s.record.schema();
  const Splitters splitters = first_splitters(source.count, survey, options);
  const std::size_t pieces = splitters.pieces();
  s.store.emplace(pieces + 1, record_schema_.stride, block_bytes(options, pieces, record_schema_.stride),
                  options.spill);
  const auto read = [&](std::uint64_t row, std::span<std::byte> records) {
    read_fully(source, row, records);
    if (options.progress) options.progress(row + records.size() / source.schema.stride);
  };
  const std::vector<Box> boxes = distribute({.schema = source.schema,
                                             .count = source.count,
                                             .read = read,
                                             .record = s.record,
                                             .key = static_cast<SortKey>(axis_),
                                             .splitters = splitters,
                                             .first_list = 0,
                                             .nonfinite_list = pieces,
                                             .memory_bytes = options.buffer_bytes / 4},
                                            *s.store);
  s.store->finish();

  SplitOptions split{.axis = axis_,
                     .aim = std::max<std::uint64_t>(1, options.slab_points),
                     .most = most_points(options),
                     .most_pieces = most_pieces(options),
                     .buffer_bytes = options.buffer_bytes / 4};
  split.aim = std::min(split.aim, split.most);
  std::vector<StreamPiece> found;
  for (std::size_t p = 0; p < pieces; ++p) found.push_back({p, s.store->count(p), boxes[p]});
  slabs_ = s.join_pieces(split_large_pieces(found, record_schema_, split, *s.store), split.aim);

  nonfinite_count_ = s.store->count(pieces);
  split.most = split.aim = std::max<std::uint64_t>(1, options.buffer_bytes / 8 / record_schema_.stride);
  s.nonfinite_list = sort_list_by_row(pieces, record_schema_, split, *s.store);
}

Stream::~Stream() = default;

std::uint64_t Stream::spilled_bytes() const { return state_->store->spilled_bytes(); }
std::uint64_t Stream::memory_bytes() const { return state_->store->memory_bytes(); }

void Stream::read(std::size_t slab, std::span<std::byte> out) const {
  const State& s = *state_;
  assert(out.size() == slabs_[slab].count * record_schema_.stride);
  for (std::size_t p = s.first_piece[slab]; p < s.first_piece[slab + 1]; ++p) {
    const std::size_t bytes = s.pieces[p].count * record_schema_.stride;
    s.store->read(s.pieces[p].list, 0, out.first(bytes));
    out = out.subspan(bytes);
  }
}

void Stream::read_nonfinite(std::uint64_t first, std::span<std::byte> out) const {
  state_->store->read(state_->nonfinite_list, first, out);
}

}  // namespace pointsweep
