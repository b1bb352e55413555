// SPDX-License-Identifier: MIT
#include "pointsweep/order/stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/order/distribution.h"
#include "pointsweep/order/pieces.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/order/slabs_on_demand.h"
#include "pointsweep/order/working_record.h"

namespace pointsweep {
namespace {

constexpr Encoding kStreamEncoding{"stream", 1};
constexpr std::size_t kMostPieces = 4096;    ///< most pieces that one pass makes
constexpr std::size_t kFewPieces = 64;       ///< blocks are small enough for at least this many pieces in the buffers
constexpr std::size_t kSamplesPerSlab = 16;  ///< fewer samples would make slabs uneven
constexpr std::size_t kLeastBlock = 8192, kLargestBlock = 1 << 20;  ///< bytes

/// Returns the most points of a slab. Larger slabs are split, along other axes too if needed.
std::uint64_t most_points(const StreamOptions& options) {
  const std::uint64_t aim = std::max<std::uint64_t>(1, options.slab_points);
  return options.max_slab_points != 0 ? options.max_slab_points : 2 * aim;
}

std::size_t most_pieces(const StreamOptions& options) {
  return std::clamp<std::size_t>(options.buffer_bytes / 2 / kLeastBlock, 2, kMostPieces);
}

/// Returns the bytes of a block of a slab. In memory, blocks are small relative to a slab, so that little of the last
/// block is wasted. Spilled blocks are as large as the buffers allow, so that the disk writes long pieces.
std::size_t block_bytes(const StreamOptions& options, std::size_t pieces, std::size_t record_bytes) {
  if (!options.spill)
    return std::clamp<std::size_t>(options.slab_points * record_bytes / 16, kLeastBlock / 2, kLargestBlock / 4);
  const std::size_t open = std::max(pieces + 1, kFewPieces);
  return std::clamp<std::size_t>(options.buffer_bytes / 2 / open, kLeastBlock, kLargestBlock);
}

/// Returns Splitters for at most `most` pieces of about `aim` points each. A sample point stands for
/// `points_per_sample` points; `spacing` is the spacing at each sample point.
Splitters splitters_of(const std::vector<Vec3>& sample, const std::vector<double>& spacing, std::uint64_t aim,
                       std::size_t most, double points_per_sample, const StreamOptions& options) {
  std::vector<double> coordinates;
  for (const Vec3& p : sample) coordinates.push_back(p[options.axis]);
  const double points = points_per_sample * static_cast<double>(sample.size());
  const auto wanted = static_cast<std::uint64_t>(points) / std::max<std::uint64_t>(1, aim) + 1;
  const std::size_t pieces = std::min<std::uint64_t>({wanted, most, sample.size() / kSamplesPerSlab + 1});
  std::vector<double> sorted = coordinates;
  std::vector<double> limits = quantile_limits(sorted, pieces);
  if (!options.canonical) limits = limits_not_too_near(limits, coordinates, spacing);
  return Splitters(limits);
}

/// Returns the number of points per slab of sparse places. Points in sparse places are few, so larger slabs would save
/// little; slabs of fewer points would be so thin that their leaves (of 16 points) would extend across the cloud.
std::uint64_t sparse_aim(const StreamOptions& options) { return std::min<std::uint64_t>(options.slab_points, 4096); }

/// Returns one Splitters for the whole cloud, or one for its dense part and one for its sparse places.
std::vector<Splitters> first_splitters(std::uint64_t points, const Survey& survey, const LocalSpacing& spacing,
                                       const StreamOptions& options, std::size_t most) {
  const double each = static_cast<double>(points) / static_cast<double>(std::max<std::size_t>(survey.sample.size(), 1));
  if (options.canonical || !spacing.has_sparse_places()) {
    return {splitters_of(survey.sample, spacing.at_sample(), options.slab_points, most, each, options)};
  }
  std::array<std::vector<Vec3>, 2> sample;
  std::array<std::vector<double>, 2> spacings;
  for (std::size_t i = 0; i < survey.sample.size(); ++i) {
    const std::size_t sparse = spacing.is_sparse(survey.sample[i]);
    sample[sparse].push_back(survey.sample[i]);
    spacings[sparse].push_back(spacing.at_sample()[i]);
  }
  const Splitters thin = splitters_of(sample[1], spacings[1], sparse_aim(options), (most + 3) / 4, each, options);
  const std::size_t rest = std::max<std::size_t>(most - std::min(most, thin.pieces()), 1);
  return {splitters_of(sample[0], spacings[0], options.slab_points, rest, each, options), thin};
}

/// Returns the number of rows that are decoded together. The number is small, so that the rows of a block lie close
/// together in space, but large enough for efficient reads.
std::uint64_t block_rows(const PointSource& source, const OnDemandOptions& how) {
  constexpr std::uint64_t kBytes = 512 << 10, kLeastRows = 256, kMostRows = 8192, kMostBlocks = 1 << 18;
  if (how.block_rows != 0) return how.block_rows;
  return std::max(std::clamp(kBytes / source.schema.stride, kLeastRows, kMostRows), source.count / kMostBlocks);
}

/// A slab and the stored pieces that contain its records.
struct PiecedSlab {
  Slab slab;
  std::vector<StreamPiece> pieces;

  void encode(Encoder& out) const {
    out.put<std::uint64_t>(slab.first);
    out.put<std::uint64_t>(slab.count);
    out.put_box(slab.box);
    out.put<std::uint64_t>(slab.least_row);
    out.put_list(pieces, [&](const StreamPiece& piece) {
      out.put<std::uint64_t>(piece.list);
      out.put<std::uint64_t>(piece.count);
      out.put_box(piece.box);
      out.put<std::uint64_t>(piece.least_row);
    });
  }
  static PiecedSlab decode(Decoder& in) {
    const auto get = [&in] { return in.get<std::uint64_t>(); };
    const Slab slab{get(), get(), in.get_box(), get()};
    return {slab, in.get_list<StreamPiece>([&] { return StreamPiece{get(), get(), in.get_box(), get()}; })};
  }
};

/// Returns the indices of the source fields that working records carry; empty for all fields.
std::vector<std::size_t> wanted_fields(const Schema& schema, const StreamOptions& options) {
  std::vector<std::size_t> wanted;
  if (options.whole_records || options.numbered) return wanted;
  wanted.assign(options.payload.begin(), options.payload.end());
  for (const char* axis : {"x", "y", "z"})
    if (const auto field = schema.find(axis)) wanted.push_back(*field);
  return wanted;
}

}  // namespace

struct Stream::State {
  State(const PointSource& source, const StreamOptions& options)
      : record(options.numbered ? WorkingRecord(source.schema)
                                : WorkingRecord(source.schema, options.whole_records, options.payload, source.count)) {
    split.axis = options.axis;
    split.most = most_points(options);
    split.aim = std::clamp<std::uint64_t>(options.slab_points, 1, split.most);
    split.most_pieces = most_pieces(options);
    split.buffer_bytes = options.buffer_bytes / 4;
    split.canonical = options.canonical;
  }

  /// Distributes the points of the source among the pieces of the splitters. Returns, for each Splitters, its pieces.
  std::vector<std::vector<StreamPiece>> partition(const PointSource& source, const std::vector<Splitters>& splitters,
                                                  const LocalSpacing& spacing, const StreamOptions& options) {
    std::size_t count = 0;
    for (const Splitters& s : splitters) count += s.pieces();
    const std::size_t record_bytes = record.schema().stride;
    const std::size_t block = block_bytes(options, count, record_bytes);
    store.emplace(count + 1, record_bytes, block, options.spill);
    if (options.spill) {  // a pass has one block in memory for each piece that it fills
      split.most_pieces = std::clamp<std::size_t>(options.buffer_bytes / 2 / block, 2, split.most_pieces);
    }
    nonfinite_list = count;
    const auto read = [&](std::uint64_t row, std::span<std::byte> records) { read_fully(source, row, records); };
    const auto for_thread = [&]() -> ReadRecords {
      ReadRows own = source.for_thread ? source.for_thread(wanted_fields(source.schema, options)) : ReadRows();
      if (!own) return {};
      return [&source, own](std::uint64_t row, std::span<std::byte> to) { read_fully(source, own, row, to); };
    };
    const std::vector<Box> boxes = distribute({.schema = source.schema,
                                               .count = source.count,
                                               .read = read,
                                               .record = record,
                                               .key = static_cast<SortKey>(options.axis),
                                               .splitters = splitters,
                                               .first_list = 0,
                                               .nonfinite_list = nonfinite_list,
                                               .memory_bytes = options.buffer_bytes / 4,
                                               .spacing = &spacing,
                                               .for_thread = for_thread,
                                               .chunk_end = source.for_thread ? source.chunk_end : nullptr,
                                               .progress = options.progress},
                                              *store);
    store->finish();
    return by_splitter(splitters, boxes, [this](std::size_t piece) { return store->count(piece); });
  }

  template <class CountOf>
  static std::vector<std::vector<StreamPiece>> by_splitter(const std::vector<Splitters>& splitters,
                                                           const std::vector<Box>& boxes, const CountOf& count_of) {
    std::vector<std::vector<StreamPiece>> pieces;
    std::size_t piece = 0;
    for (const Splitters& s : splitters) {
      pieces.emplace_back();
      for (const std::size_t end = piece + s.pieces(); piece < end; ++piece)
        pieces.back().push_back({piece, count_of(piece), boxes[piece]});
    }
    return pieces;
  }

  /// Joins adjacent pieces that have at most `aim` points together, since the cells of a thin slab would be flat. A
  /// piece whose points all have one position stays a separate slab, which need not wait for the slabs around it.
  static std::vector<PiecedSlab> join(const std::vector<StreamPiece>& pieces, std::uint64_t aim) {
    std::vector<PiecedSlab> slabs;
    bool after_copies = false;
    for (const StreamPiece& piece : pieces) {
      const bool copies = piece.count > 1 && piece.box.lo == piece.box.hi;
      if (slabs.empty() || copies || after_copies || slabs.back().slab.count + piece.count > aim) {
        slabs.push_back({{0, 0, {}, piece.least_row}, {}});
      }
      after_copies = copies;
      slabs.back().slab.count += piece.count;
      slabs.back().slab.least_row = std::min(slabs.back().slab.least_row, piece.least_row);
      slabs.back().slab.box.include(piece.box);
      slabs.back().pieces.push_back(piece);
    }
    return slabs;
  }

  void make_slabs(const std::vector<StreamPiece>& pieces, std::uint64_t aim) {
    SplitOptions options = split;
    options.aim = std::clamp<std::uint64_t>(aim, 1, split.most);
    merge(join(split_large_pieces(pieces, record.schema(), options, *store), options.aim));
  }

  /// Inserts each slab of `others` into `slabs` as late as possible, but before the first slab that reaches the begin
  /// of this or a later slab of `others`, so that slabs do not wait for these few points. Both lists keep order.
  void merge(std::vector<PiecedSlab> others) {
    const std::vector<double> begin_of_others = least_begins(others);
    std::vector<PiecedSlab> merged;
    std::size_t i = 0;
    for (std::size_t o = 0; o < others.size(); ++o) {
      while (i < slabs.size() && slabs[i].slab.box.hi[split.axis] < begin_of_others[o])
        merged.push_back(std::move(slabs[i++]));
      merged.push_back(std::move(others[o]));
    }
    while (i < slabs.size()) merged.push_back(std::move(slabs[i++]));
    slabs = std::move(merged);
  }

  /// Returns, for each slab, the least coordinate along the axis of its points and those of all later slabs.
  std::vector<double> least_begins(const std::vector<PiecedSlab>& of) const {
    std::vector<double> begins(of.size());
    double least = Box::kInf;
    for (std::size_t s = of.size(); s-- > 0;) begins[s] = least = std::min(least, of[s].slab.box.lo[split.axis]);
    return begins;
  }

  void sort_nonfinite() {
    SplitOptions by_row = split;
    by_row.canonical = true;
    by_row.most = by_row.aim = std::max<std::uint64_t>(1, split.buffer_bytes / 2 / record.schema().stride);
    nonfinite_list = sort_list_by_row(nonfinite_list, record.schema(), by_row, *store);
  }

  /// Joins the counted pieces into slabs and returns the slabs, or nothing and, in `why_not`, the reason.
  std::optional<CountedSlabs> join_counted(const PieceCounts& counts, const std::vector<Splitters>& splitters,
                                           const StreamOptions& options, std::string& why_not) {
    if (counts.nonfinite > 0) {
      why_not = fmt::format("{} {} no finite coordinates", counts.nonfinite,
                            counts.nonfinite == 1 ? "point has" : "points have");
      return {};
    }
    auto pieces = by_splitter(splitters, counts.boxes, [&](std::size_t piece) { return counts.points[piece]; });
    for (std::vector<StreamPiece>& of_splitter : pieces) {
      std::erase_if(of_splitter, [](const StreamPiece& piece) { return piece.count == 0; });
      for (const StreamPiece& piece : of_splitter) {
        if (piece.count <= split.most) continue;
        why_not = fmt::format("{} points lie so close along {} that their slab has to be split", piece.count,
                              "xyz"[split.axis]);
        return {};
      }
    }
    slabs = join(pieces[0], split.aim);
    if (pieces.size() > 1) merge(join(pieces[1], std::clamp<std::uint64_t>(sparse_aim(options), 1, split.most)));
    return counted_slabs(counts, splitters);
  }

  CountedSlabs counted_slabs(const PieceCounts& counts, const std::vector<Splitters>& splitters) const {
    CountedSlabs counted;
    counted.splitters = splitters;
    counted.slab_of_piece.assign(counts.points.size(), ~std::uint32_t{0});
    for (std::uint32_t slab = 0; slab < slabs.size(); ++slab) {
      counted.points.push_back(slabs[slab].slab.count);
      for (const StreamPiece& piece : slabs[slab].pieces) counted.slab_of_piece[piece.list] = slab;
    }
    for (const RowBlock& block : counts.blocks) {
      PieceRange in;  // range of slabs; along the pieces of one Splitters, the numbers of the slabs ascend
      for (const PieceRange& range : block.pieces) {
        if (range.empty()) continue;
        in.include(counted.slab_of_piece[range.first]);
        in.include(counted.slab_of_piece[range.last]);
      }
      if (!in.empty())
        counted.blocks.push_back({block.first_row, static_cast<std::uint32_t>(block.rows), in.first, in.last});
    }
    return counted;
  }

  WorkingRecord record;
  SplitOptions split;
  std::optional<SlabStore> store;
  std::optional<SlabsOnDemand> on_demand;  ///< used instead of the store for a stream on demand
  std::vector<PiecedSlab> slabs;
  std::size_t nonfinite_list = 0;
};

Stream::Stream(const PointSource& source, const Survey& survey, const StreamOptions& options)
    : axis_(options.axis), state_(std::make_unique<State>(source, options)) {
  State& s = *state_;
  record_schema_ = s.record.schema();
  LocalSpacing spacing(survey.sample, source.count, survey.dimension);
  const auto pieces = s.partition(source, first_splitters(source.count, survey, spacing, options, most_pieces(options)),
                                  spacing, options);
  s.make_slabs(pieces[0], options.slab_points);
  if (pieces.size() > 1) s.make_slabs(pieces[1], sparse_aim(options));
  number_slabs();
  if (options.canonical) spacing_ = std::move(spacing);
  nonfinite_count_ = s.store->count(s.nonfinite_list);
  s.sort_nonfinite();
}

void Stream::number_slabs() {
  for (PiecedSlab& slab : state_->slabs) {
    slab.slab.first = slabs_.empty() ? 0 : slabs_.back().first + slabs_.back().count;
    slabs_.push_back(slab.slab);
  }
  swept_slabs_ = slabs_.size();
}

Stream::Stream(int axis, std::unique_ptr<State> state) : axis_(axis), state_(std::move(state)) {
  record_schema_ = state_->record.schema();
  number_slabs();
}

Stream::Stream(Stream&&) noexcept = default;

std::optional<Stream> Stream::on_demand(const PointSource& source, const Survey& survey, const StreamOptions& options,
                                        const OnDemandOptions& how, std::string& why_not) {
  auto state = std::make_unique<State>(source, options);
  LocalSpacing spacing(survey.sample, source.count, survey.dimension);
  const std::vector<Splitters> splitters = first_splitters(source.count, survey, spacing, options, kMostPieces);
  const PieceFinder finder(splitters, &spacing);
  std::vector<RowBlock> blocks = cut_into_blocks(source.count, block_rows(source, how), how.boxes);
  const PieceCounts counts = count_pieces(source, finder, options.axis, std::move(blocks), options.progress);
  std::optional<CountedSlabs> slabs = state->join_counted(counts, splitters, options, why_not);
  if (!slabs) return {};
  slabs->spacing = spacing;
  const std::uint64_t waiting = most_waiting(*slabs, how.read_ahead);
  if (waiting > how.most_waiting) {
    why_not =
        fmt::format("{} points would wait in memory for the sweep, which has room for {}", waiting, how.most_waiting);
    return {};
  }
  state->on_demand.emplace(source, state->record, wanted_fields(source.schema, options), options.axis,
                           std::move(*slabs), how.read_ahead, how.most_waiting);
  Stream stream(options.axis, std::move(state));
  if (options.canonical) stream.spacing_ = std::move(spacing);
  return stream;
}

Stream::Stream(Decoder& in, const PointSource& source, const StreamOptions& options)
    : state_(std::make_unique<State>(source, options)) {
  State& s = *state_;
  in.begin(kStreamEncoding);
  axis_ = in.get<std::uint8_t>();
  record_schema_ = s.record.schema();
  spacing_ = LocalSpacing::decode(in);
  s.slabs = in.get_list<PiecedSlab>([&] { return PiecedSlab::decode(in); });
  for (const PiecedSlab& slab : s.slabs) slabs_.push_back(slab.slab);
  swept_slabs_ = slabs_.size();
  s.nonfinite_list = in.get<std::uint64_t>();
  s.store.emplace(in, record_schema_.stride, kLeastBlock, options.spill);
  const auto is_stored = [&](std::uint64_t list, std::uint64_t count) {
    return list < s.store->slabs() && count <= s.store->count(list);
  };
  const bool are_stored = std::ranges::all_of(s.slabs, [&](const PiecedSlab& slab) {
    return std::ranges::all_of(slab.pieces, [&](const StreamPiece& p) { return is_stored(p.list, p.count); });
  });
  if (axis_ > 2 || !are_stored || !is_stored(s.nonfinite_list, 0)) fail("The slabs of a stored stream are damaged.");
  nonfinite_count_ = s.store->count(s.nonfinite_list);
}

Stream::Stream(StoredSlabs stored) : axis_(stored.axis), stored_(std::move(stored)) {
  slabs_ = std::move(stored_.slabs);
  swept_slabs_ = stored_.swept_slabs;
  nonfinite_count_ = stored_.nonfinite_count;
  record_schema_ = std::move(stored_.record_schema);
}

Stream::~Stream() = default;

void Stream::encode(Encoder& out) const {
  out.begin(kStreamEncoding);
  out.put<std::uint8_t>(static_cast<std::uint8_t>(axis_));
  spacing_.encode(out);
  out.put_list(state_->slabs, [&](const PiecedSlab& slab) { slab.encode(out); });
  out.put<std::uint64_t>(state_->nonfinite_list);
  state_->store->encode(out);
}

std::uint64_t Stream::spilled_bytes() const { return state_ && state_->store ? state_->store->spilled_bytes() : 0; }
std::uint64_t Stream::memory_bytes() const { return state_ && state_->store ? state_->store->memory_bytes() : 0; }

void Stream::read(std::size_t slab, std::span<std::byte> out) const {
  assert(out.size() == slabs_[slab].count * record_schema_.stride);
  if (!state_) return stored_.read(slab, out);
  State& s = *state_;
  if (s.on_demand) return s.on_demand->read(slab, out);
  for (const StreamPiece& piece : s.slabs[slab].pieces) {
    const std::size_t bytes = piece.count * record_schema_.stride;
    s.store->read(piece.list, 0, out.first(bytes));
    out = out.subspan(bytes);
  }
}

void Stream::read_nonfinite(std::uint64_t first, std::span<std::byte> out) const {
  if (!state_) return stored_.read_nonfinite(first, out);
  if (state_->store) state_->store->read(state_->nonfinite_list, first, out);
}

}  // namespace pointsweep
