// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/decoded_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <tuple>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBatchBytes = 1 << 20;  ///< that a thread decodes before it writes them

/// The records of another reader, from a temporary file.
class DecodedReader final : public Reader {
 public:
  using Progress = std::function<void(std::uint64_t rows)>;

  /// Decodes all rows of `encoded` with up to `threads` threads; progress is told by one thread at a time how many rows
  /// are done.
  DecodedReader(Reader& encoded, const SpillPlace& place, unsigned threads, const Progress& progress)
      : encoded_(encoded), file_(place) {
    info_ = encoded.info();
    info_.decode_once = false;
    info_.decoder_bytes = 0;
    file_.reserve(info_.count * info_.schema.stride);
    if (encoded.has_decoders())
      decode_side_by_side(encoded, threads, progress);
    else
      store(
          0, info_.count, [&](std::uint64_t row, auto records) { return encoded.read(row, records); }, progress);
  }

  bool has_decoders() const override { return true; }
  bool decodes_any_range() const override { return true; }
  /// Returns the chunk of the encoded file, with its box; the byte range is empty, since the file is not read any more.
  Chunk chunk_of(std::uint64_t row) const override {
    Chunk chunk = encoded_.chunk_of(row);
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
      if (rows != 0) reader_.file_.read(row * stride, records.first(rows * stride));
      return rows;
    }

   private:
    const DecodedReader& reader_;
  };

  void decode_side_by_side(const Reader& encoded, unsigned threads, const Progress& progress) {
    std::mutex taking;
    std::uint64_t next = 0, done = 0;
    const auto take = [&] {
      const std::lock_guard lock(taking);
      const std::uint64_t first = next;
      if (first < info_.count) next = encoded.chunk_of(first).end_row();
      return std::pair(first, next);
    };
    const auto note = [&](std::uint64_t rows) {
      const std::lock_guard lock(taking);
      progress(done += rows);
    };
    parallel_for(threads, [&](std::size_t, unsigned) {
      const std::unique_ptr<RowDecoder> decoder = encoded.decoder();
      for (auto [first, end] = take(); first < info_.count; std::tie(first, end) = take()) {
        const auto read = [&](std::uint64_t row, auto records) { return decoder->read(row, records); };
        store(first, end, read, [](std::uint64_t) {});
        note(end - first);
      }
    });
  }

  template <class Read>
  void store(std::uint64_t first, std::uint64_t end, const Read& read, const Progress& progress) {
    const std::size_t stride = info_.schema.stride;
    std::vector<std::byte> batch(std::max(stride, kBatchBytes / stride * stride));
    while (first < end) {
      stop_if_cancelled();
      const std::size_t most = std::min<std::uint64_t>(batch.size(), (end - first) * stride);
      const std::size_t rows = read(first, std::span(batch).first(most));
      if (rows == 0) fail("{}: ends before its last point; run again once it is complete.", info_.path.string());
      file_.write(first * stride, std::span(batch).first(rows * stride));
      first += rows;
      progress(first);
    }
  }

  const Reader& encoded_;  ///< lives as long (DecodedInput)
  SpillFile file_;
};

/// So many that they take at most half of the memory budget.
unsigned threads_for(const FileInfo& info, const EngineOptions& options) {
  const std::uint64_t budget = memory_budget(options.resources.memory_bytes);
  const std::uint64_t most =
      budget / 2 / (info.decoder_bytes + std::max<std::uint64_t>(kBatchBytes, info.schema.stride));
  return static_cast<unsigned>(std::clamp<std::uint64_t>(most, 1, thread_count()));
}

std::uint64_t decoded_bytes(const FileInfo& info) { return info.decode_once ? info.count * info.schema.stride : 0; }

}  // namespace

DecodedInput::DecodedInput(InputCloud& cloud, const EngineOptions& options,
                           const std::function<SpillPlace(std::size_t input)>& place)
    : cloud_(cloud), bytes_(decoded_input_bytes(cloud)) {
  std::uint64_t before = 0;  // rows of the inputs in front
  try {
    for (std::size_t i = 0; i < cloud.readers().size(); ++i) {
      Reader& encoded = *cloud.readers()[i];
      const auto progress = [&](std::uint64_t rows) {
        if (options.observer != nullptr) options.observer->on_progress({"decoding", before + rows, cloud.count(), 0});
      };
      if (decoded_bytes(encoded.info()) != 0) {
        auto decoded =
            std::make_unique<DecodedReader>(encoded, place(i), threads_for(encoded.info(), options), progress);
        encoded.rest();
        originals_.emplace_back(i, cloud.exchange_reader(i, std::move(decoded)));
      }
      before += cloud.readers()[i]->info().count;
    }
  } catch (...) {
    put_back();
    throw;
  }
}

DecodedInput::~DecodedInput() { put_back(); }

void DecodedInput::put_back() {
  for (auto& [input, reader] : originals_) cloud_.exchange_reader(input, std::move(reader));
  originals_.clear();
}

std::uint64_t decoded_input_bytes(const InputCloud& cloud) {
  std::uint64_t bytes = 0;
  for (const auto& reader : cloud.readers()) bytes += decoded_bytes(reader->info());
  return bytes;
}

std::string decoded_input_text(std::uint64_t bytes) {
  if (bytes == 0) return "";
  return fmt::format("decoding      once, into a temporary file of {:.1f} MB\n",
                     static_cast<double>(bytes) / (1 << 20));
}

}  // namespace pointsweep
