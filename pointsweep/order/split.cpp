// SPDX-License-Identifier: MIT

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/order/distribution.h"
#include "pointsweep/order/pieces.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSamplesPerPiece = 64, kLeastSample = 4096;
constexpr std::size_t kReadBytes = 256 << 10;

/// Splits the pieces of a store until none is too large. A level is the index of a sort key in keys_.
class Splitting {
  static constexpr std::size_t kRowLevel = 3;
  using Sample = std::array<std::vector<double>, kRowLevel + 1>;  ///< for each level, the values of its key

 public:
  Splitting(const Schema& working, const SplitOptions& options, SlabStore& store)
      : working_(working),
        record_(working),
        position_(position_fields(working, "the stream")),
        options_(options),
        store_(store),
        keys_{static_cast<SortKey>(options.axis)} {
    for (const SortKey key : {SortKey::x, SortKey::y, SortKey::z})
      if (key != keys_[0]) keys_.push_back(key);
    keys_.push_back(SortKey::row);
  }

  /// Appends `piece`, or the pieces into which it is split, to `done`. If options_.canonical, all points of the
  /// piece must be equal in the keys before `level`.
  void split(const StreamPiece& piece, std::size_t level) {
    stop_if_cancelled();
    if (piece.count == 0) return;
    if (piece.count <= options_.most) {
      done.push_back(piece);
      return;
    }
    const Sample sample = sample_of(piece);
    if (!options_.canonical) level = level_of_widest_spread(piece, sample);
    while (keys_[level] != SortKey::row && !(lowest(piece, level) < highest(piece, level))) ++level;
    for (const StreamPiece& part : parts_of(piece, level, sample[level])) split(part, level);
  }

  void split_by_row(const StreamPiece& piece) { split(piece, kRowLevel); }

  std::vector<StreamPiece> done;

 private:
  double lowest(const StreamPiece& piece, std::size_t level) const {
    return piece.box.lo[static_cast<int>(keys_[level])];
  }
  double highest(const StreamPiece& piece, std::size_t level) const {
    return piece.box.hi[static_cast<int>(keys_[level])];
  }

  /// Returns the level of the coordinate with the widest spread over the middle four fifths of the sample. So
  /// outliers cannot cause splits of a noisy wall into sheets thinner than its noise. On a tie, returns the level with
  /// the longer side of the piece's box.
  std::size_t level_of_widest_spread(const StreamPiece& piece, const Sample& sample) const {
    std::size_t widest = 0;
    std::array<double, 2> most{};
    for (std::size_t level = 0; level < kRowLevel; ++level) {
      std::vector<double> values = sample[level];
      const auto tenth = static_cast<std::ptrdiff_t>(values.size() / 10);
      std::ranges::sort(values);
      const double middle = values.empty() ? 0 : values.end()[-1 - tenth] - values.begin()[tenth];
      const std::array spread{middle, highest(piece, level) - lowest(piece, level)};
      if (spread > most) most = spread, widest = level;
    }
    return widest;
  }

  std::vector<StreamPiece> parts_of(const StreamPiece& piece, std::size_t level, std::vector<double> sample) {
    const std::vector<double> part_limits = limits(piece, level, std::move(sample));
    const Splitters splitters(part_limits);
    const std::size_t first = store_.add_slabs(splitters.pieces());
    const auto read = [&](std::uint64_t i, std::span<std::byte> records) {
      store_.release_before(piece.list, i);  // so that no record takes memory or space in the file twice
      store_.read(piece.list, i, records);
    };
    const std::vector<Box> boxes = distribute({.schema = working_,
                                               .count = piece.count,
                                               .read = read,
                                               .record = record_,
                                               .key = keys_[level],
                                               .splitters = {&splitters, 1},
                                               .first_list = first,
                                               .nonfinite_list = {},
                                               .memory_bytes = options_.buffer_bytes},
                                              store_);
    store_.finish();
    store_.release(piece.list);
    std::vector<StreamPiece> parts;
    for (std::size_t p = 0; p < boxes.size(); ++p) {
      const bool by_row = keys_[level] == SortKey::row && p > 0;
      parts.push_back({first + p, store_.count(first + p), boxes[p],
                       by_row ? static_cast<std::uint64_t>(part_limits[p - 1]) : piece.least_row});
    }
    return parts;
  }

  /// Returns limits with points of the piece on both sides, so that every split makes progress.
  std::vector<double> limits(const StreamPiece& piece, std::size_t level, std::vector<double> sample) const {
    std::vector<double> result = quantile_limits(sample, parts(piece));
    if (keys_[level] == SortKey::row) return result;  // no two rows are equal, so their quantiles differ
    const double lo = lowest(piece, level), hi = highest(piece, level);
    std::erase_if(result, [&](double limit) { return limit <= lo || limit > hi; });
    if (result.empty()) result.push_back(std::nextafter(lo, std::numeric_limits<double>::infinity()));
    return result;
  }

  std::size_t parts(const StreamPiece& piece) const {
    return std::clamp<std::uint64_t>((piece.count - 1) / options_.aim + 1, 2, options_.most_pieces);
  }

  /// Returns all keys of a sample of the records. The sample depends only on the rows of the records, since the order
  /// in which threads stored them differs between runs.
  Sample sample_of(const StreamPiece& piece) const {
    const std::uint64_t size = std::max(kLeastSample, kSamplesPerPiece * parts(piece));
    const std::uint64_t every = piece.count / size + 1;
    const std::uint64_t below = std::numeric_limits<std::uint64_t>::max() / every;
    const std::size_t stride = working_.stride;
    const std::uint64_t chunk = std::max<std::size_t>(1, kReadBytes / stride);
    std::vector<std::byte> records(std::min(chunk, piece.count) * stride);
    Sample sample;
    for (std::uint64_t first = 0; first < piece.count; first += chunk) {
      const std::size_t n = std::min(chunk, piece.count - first);
      store_.read(piece.list, first, {records.data(), n * stride});
      for (std::size_t i = 0; i < n; ++i) {
        const std::byte* record = records.data() + i * stride;
        if (mix(row_of(working_, record)) <= below) add_keys(record, sample);
      }
    }
    return sample;
  }

  void add_keys(const std::byte* record, Sample& sample) const {
    Vec3 p;
    decode_positions(position_, record, working_.stride, 1, &p.x, &p.y, &p.z);
    for (std::size_t level = 0; level < kRowLevel; ++level) {
      sample[level].push_back(p[static_cast<int>(keys_[level])]);
    }
    sample[kRowLevel].push_back(static_cast<double>(row_of(working_, record)));
  }

  const Schema& working_;
  WorkingRecord record_;
  PositionFields position_;
  const SplitOptions& options_;
  SlabStore& store_;
  std::vector<SortKey> keys_;  ///< in canonical order: the axis, the other coordinates, the row
};

}  // namespace

std::vector<StreamPiece> split_large_pieces(const std::vector<StreamPiece>& pieces, const Schema& working,
                                            const SplitOptions& options, SlabStore& store) {
  Splitting splitting(working, options, store);
  for (const StreamPiece& piece : pieces) splitting.split(piece, 0);
  return std::move(splitting.done);
}

std::size_t sort_list_by_row(std::size_t list, const Schema& working, const SplitOptions& options, SlabStore& store) {
  Splitting splitting(working, options, store);
  splitting.split_by_row({list, store.count(list), {}});
  const std::size_t sorted_list = store.add_slabs(1);
  const std::size_t stride = working.stride;
  for (const StreamPiece& piece : splitting.done) {
    std::vector<std::byte> records(piece.count * stride), sorted(piece.count * stride);
    store.read(piece.list, 0, records);
    store.release(piece.list);
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (std::size_t i = 0; i < piece.count; ++i) order.emplace_back(row_of(working, &records[i * stride]), i);
    std::ranges::sort(order);
    for (std::size_t i = 0; i < piece.count; ++i)
      std::memcpy(&sorted[i * stride], &records[order[i].second * stride], stride);
    store.append(sorted_list, sorted);
  }
  store.finish();
  return sorted_list;
}

}  // namespace pointsweep
