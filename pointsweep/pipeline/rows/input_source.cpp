// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/input_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/pipeline/available_memory.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Returns the boxes of the selects at the beginning of the chain that have a box (SelectOperator::extent()). In x and
/// y, each box contains all points that its select keeps.
std::vector<Box> first_extents(const ChainPlan& plan) {
  std::vector<Box> extents;
  for (const GraphNode& node : plan.graph.nodes) {
    if (node.op() == nullptr) continue;  // not an operator, so it moves no point
    const auto* const select = std::get_if<std::shared_ptr<const SelectOperator>>(node.op());
    if (select == nullptr) break;
    if (const std::optional<Box> extent = (*select)->extent()) extents.push_back(*extent);
  }
  return extents;
}

/// Returns whether two boxes touch in x and y, or have a gap of at most `step`, a step of the grid of the cloud, since
/// programs round the boxes of nodes.
bool meet(const Box& a, const Box& b, Vec3 step) {
  return a.lo.x <= b.hi.x + step.x && b.lo.x <= a.hi.x + step.x && a.lo.y <= b.hi.y + step.y &&
         b.lo.y <= a.hi.y + step.y;
}

/// Returns the reason why the request rules out slabs on demand (OnDemandOrder::why_not); empty if it does not.
std::string ruled_out_by_request(const ChainPlan& planned, const EngineOptions& options) {
  const bool forced = options.ordering == Ordering::on_demand;
  if (options.ordering == Ordering::distribution) return "it was asked for";
  if (options.engine != Engine::exact) return "the reference engine reads slabs more than once";
  if (!options.resume_folder.empty()) return "--resume keeps the points in order in its folder";
  if (!options.half_way_states.empty()) return "half-way states are noted";
  if (options.spill && !forced) return "everything is to be spilled";
  const std::size_t first = first_ordered_pass(planned);
  if (first < planned.passes.size() && planned.passes[first].has_places())
    return fmt::format("{} does not order points by their positions", planned.passes[first].in_order()->name());
  for (std::size_t p = 0; p < first; ++p)
    if (planned.passes[p].selects || !planned.passes[p].carried.empty())
      return "a pass before leaves out rows or carries values on";
  return "";
}

/// Returns the reason why the inputs rule out slabs on demand (OnDemandOrder::why_not); empty if they do not.
std::string ruled_out_by_inputs(const InputCloud& cloud) {
  if (cloud.selection() != nullptr) return "rows are left out";
  for (const auto& reader : cloud.readers())
    if (!reader->decodes_any_range() && !reader->info().decode_once)
      return fmt::format("{} has to be read from its beginning", reader->info().path.filename().string());
  return "";
}

constexpr std::size_t kBatchBytes = 1 << 20;    ///< bytes that a thread decodes before it writes them
constexpr std::size_t kPiecesAtOnce = 1 << 12;  ///< pieces that are listed before threads decode them

std::uint64_t decoded_bytes(const FileInfo& info) { return info.decode_once ? info.count * info.schema.stride : 0; }

/// Reads the decoded records of another reader from a temporary file.
class DecodedReader final : public Reader {
 public:
  /// The records begin at byte `begin` of `file`.
  DecodedReader(std::shared_ptr<const Reader> encoded, std::shared_ptr<const SpillFile> file, std::uint64_t begin)
      : encoded_(std::move(encoded)), file_(std::move(file)), begin_(begin) {
    info_ = encoded_->info();
    info_.decode_once = false;
    info_.decoder_bytes = 0;
  }

  bool has_decoders() const override { return true; }
  bool decodes_any_range() const override { return true; }
  /// Returns the chunk of the encoded file, with its box; the byte range is empty, since the file is not read any more.
  Chunk chunk_of(std::uint64_t row) const override {
    Chunk chunk = encoded_->chunk_of(row);
    chunk.begin = chunk.end = 0;
    return chunk;
  }
  std::unique_ptr<RowDecoder> decoder(const WantedFields&) const override { return std::make_unique<Decoder>(*this); }

 private:
  class Decoder final : public RowDecoder {
   public:
    explicit Decoder(const DecodedReader& reader) : reader_(reader) {}
    std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
      const std::size_t rows = reader_.rows_for(row, records), stride = reader_.info_.schema.stride;
      if (rows != 0) reader_.file_->read(reader_.begin_ + row * stride, records.first(rows * stride));
      return rows;
    }

   private:
    const DecodedReader& reader_;
  };

  std::shared_ptr<const Reader> encoded_;
  std::shared_ptr<const SpillFile> file_;
  std::uint64_t begin_;
};

/// Rows of an input that one thread decodes: a chunk, or all rows if the input has no decoders.
struct Piece {
  std::size_t input;
  std::uint64_t first, end;
  std::uint64_t at;  ///< offset of its records in the temporary file
};

/// Lists the pieces of all inputs that are decoded once, in order. The records of these inputs follow each other in the
/// temporary file.
class Pieces {
 public:
  explicit Pieces(const InputCloud& cloud) : cloud_(cloud) {}

  /// Returns the next pieces, at most kPiecesAtOnce; none at the end of the input.
  std::vector<Piece> next() {
    std::vector<Piece> pieces;
    while (input_ < cloud_.readers().size() && pieces.size() < kPiecesAtOnce) {
      const Reader& reader = *cloud_.readers()[input_];
      const FileInfo& info = reader.info();
      if (decoded_bytes(info) == 0 || row_ == info.count) {
        begin_ += decoded_bytes(info);
        row_ = 0;
        ++input_;
        continue;
      }
      const std::uint64_t end = reader.has_decoders() ? reader.chunk_of(row_).end_row() : info.count;
      pieces.push_back({input_, row_, end, begin_ + row_ * info.schema.stride});
      row_ = end;
    }
    return pieces;
  }

 private:
  const InputCloud& cloud_;
  std::size_t input_ = 0;
  std::uint64_t row_ = 0, begin_ = 0;  ///< row_: next row of input_; begin_: where records of input_ begin in the file
};

/// Decodes pieces for one thread.
class PieceDecoder {
 public:
  /// Writes the records of a piece to `file`. Calls `note(rows)` after each batch.
  template <class Note>
  void decode(Reader& encoded, const Piece& piece, SpillFile& file, const Note& note) {
    const std::size_t stride = encoded.info().schema.stride;
    if (encoded.has_decoders() && (!decoder_ || input_ != piece.input)) decoder_ = encoded.decoder();
    input_ = piece.input;
    std::uint64_t at = piece.at;
    for (std::uint64_t row = piece.first; row < piece.end;) {
      stop_if_cancelled();
      const std::uint64_t most = std::max<std::size_t>(1, kBatchBytes / stride);
      const std::uint64_t rows = std::min(piece.end - row, most);
      if (batch_.size() < rows * stride) batch_.resize(rows * stride);
      const std::span<std::byte> records = std::span(batch_).first(rows * stride);
      const std::size_t n = encoded.has_decoders() ? decoder_->read(row, records) : encoded.read(row, records);
      if (n == 0) fail("{}: ends before its last point; run again once it is complete.", encoded.info().path.string());
      file.write(at, records.first(n * stride));
      at += n * stride;
      row += n;
      note(n);
    }
    if (!encoded.has_decoders()) encoded.rest();
  }

 private:
  std::unique_ptr<RowDecoder> decoder_;
  std::size_t input_ = 0;  ///< input of decoder_
  std::vector<std::byte> batch_;
};

/// Returns the number of decoding threads: as many as fit in half of the memory budget, but at least one and at most
/// thread_count().
unsigned decoding_threads(const InputCloud& cloud, const EngineOptions& options) {
  std::uint64_t bytes = kBatchBytes;
  for (const auto& reader : cloud.readers())
    if (const FileInfo& info = reader->info(); info.decode_once)
      bytes = std::max(bytes, info.decoder_bytes + std::max<std::uint64_t>(kBatchBytes, info.schema.stride));
  const std::uint64_t budget = memory_budget(options.resources.memory_bytes);
  return static_cast<unsigned>(std::clamp<std::uint64_t>(budget / 2 / bytes, 1, thread_count()));
}

/// Decodes all inputs that are decoded once. Calls `progress` with the number of rows decoded so far, from one thread
/// at a time.
void decode_inputs(const InputCloud& cloud, const EngineOptions& options, SpillFile& file,
                   const std::function<void(std::uint64_t rows)>& progress) {
  std::mutex noting;
  std::uint64_t done = 0;
  const auto note = [&](std::uint64_t rows) {
    const std::lock_guard lock(noting);
    progress(done += rows);
  };
  with_threads(decoding_threads(cloud, options), [&] {
    Pieces pieces(cloud);
    std::vector<PieceDecoder> decoders(thread_count());
    for (std::vector<Piece> some = pieces.next(); !some.empty(); some = pieces.next())
      parallel_for(some.size(), [&](std::size_t i, unsigned worker) {
        decoders[worker].decode(*cloud.readers()[some[i].input], some[i], file, note);
      });
  });
}

}  // namespace

InputCloud cropped_input(const InputCloud& cloud, const ChainPlan& plan) {
  const std::vector<Box> extents = first_extents(plan);
  if (extents.empty() || plan.graph.reads_input_rows()) return cloud;
  const Vec3 step = cloud.las() ? cloud.las()->grid.scale : Vec3{};
  return cloud.with_chunks([&](const Chunk& chunk) {
    return !chunk.depth || !chunk.bounds ||
           std::ranges::all_of(extents, [&](const Box& extent) { return meet(*chunk.bounds, extent, step); });
  });
}

InputCloud input_of_chain(const InputCloud& cloud, const ChainPlan& plan, std::uint64_t first) {
  InputCloud cropped = cropped_input(cloud, plan);
  return plan.graph.reads_input_rows() ? cropped.numbered(first) : cropped;
}

PointSource source_of(InputCloud& cloud, const std::function<void(std::size_t rows)>& note) {
  const auto noted = [note](std::size_t rows) {
    note(rows);
    return rows;
  };
  return {.schema = cloud.schema(),
          .count = cloud.count(),
          .read = [&cloud, noted](std::uint64_t row,
                                  std::span<std::byte> records) { return noted(cloud.read(row, records)); },
          .for_thread = [&cloud, noted](const std::vector<std::size_t>& wanted) -> ReadRows {
            const std::shared_ptr<RowDecoder> own = cloud.decoder(wanted);
            if (!own) return {};
            return [own, noted](std::uint64_t row, std::span<std::byte> records) {
              return noted(own->read(row, records));
            };
          },
          .chunk_end = [&cloud](std::uint64_t row) { return cloud.chunk_end(row); }};
}

std::size_t first_ordered_pass(const ChainPlan& planned) {
  const auto is_ordered = [](const PlannedPass& pass) { return pass.kind != PassKind::rows; };
  return static_cast<std::size_t>(std::ranges::find_if(planned.passes, is_ordered) - planned.passes.begin());
}

OnDemandOrder on_demand_order(const InputCloud& cloud, const ChainPlan& planned, const EngineOptions& options) {
  OnDemandOrder order;
  order.why_not = ruled_out_by_request(planned, options);
  if (order.why_not.empty()) order.why_not = ruled_out_by_inputs(cloud);
  if (!order.why_not.empty()) return order;
  if (const Reader* without = cloud.stated_boxes(order.boxes);
      without != nullptr && options.ordering != Ordering::on_demand)
    order.why_not = fmt::format("{} does not state where its points lie", without->info().path.filename().string());
  return order;
}

InputCloud decoded_input(const InputCloud& cloud, const EngineOptions& options, const SpillPlace& place) {
  const auto file = std::make_shared<SpillFile>(place);
  file->reserve(decoded_input_bytes(cloud));
  decode_inputs(cloud, options, *file, [&](std::uint64_t rows) {
    if (options.observer != nullptr) options.observer->on_progress({"decoding", rows, cloud.count(), 0});
  });
  std::vector<std::shared_ptr<Reader>> readers = cloud.readers();
  std::uint64_t begin = 0;
  for (std::shared_ptr<Reader>& reader : readers) {
    const std::uint64_t bytes = decoded_bytes(reader->info());
    if (bytes != 0) reader = std::make_shared<DecodedReader>(reader, file, begin);
    begin += bytes;
  }
  return cloud.read_by(std::move(readers));
}

std::uint64_t decoded_input_bytes(const InputCloud& cloud) {
  std::uint64_t bytes = 0;
  for (const auto& reader : cloud.readers()) bytes += decoded_bytes(reader->info());
  return bytes;
}

std::string decoded_input_text(std::uint64_t bytes) {
  if (bytes == 0) return "";
  return fmt::format("decoding      once, into a temporary file of {:.1f} MB\n", megabytes(bytes));
}

}  // namespace pointsweep
