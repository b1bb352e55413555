// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cassert>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_frame.h"
#include "pointsweep/formats/las/laz_layout.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Number of chunks that are compressed at once with the least memory: about two megabytes each, and half as much for
/// the compressed chunk.
constexpr unsigned kFewChunksAtOnce = 4;

/// Returns the memory for compressing a chunk of records of `record_bytes`.
std::uint64_t chunk_bytes(std::uint64_t record_bytes) {
  constexpr std::uint64_t kModels = 2 << 20;  // an estimate from the peak memory of runs
  const std::uint64_t chunk = kLazChunkPoints * record_bytes;
  return chunk + chunk / 2 + kModels;
}

/// Returns how many chunks are compressed at once: one per thread, as far as `bytes` of memory allow, but at least
/// kFewChunksAtOnce if there are as many threads.
unsigned chunks_at_once(std::uint64_t bytes, std::uint64_t record_bytes, unsigned threads) {
  const std::uint64_t fitting = std::max<std::uint64_t>(bytes / chunk_bytes(record_bytes), kFewChunksAtOnce);
  return static_cast<unsigned>(std::clamp<std::uint64_t>(threads, 1, fitting));
}

class LazWriter : public Writer {
 public:
  explicit LazWriter(const OutputPlan& plan)
      : frame_(plan, LasPoints::compressed),
        laz_(*frame_.layout().laz),
        encoder_(frame_.layout(), plan.path.string()),
        statistics_(frame_.layout().header.point_format),
        at_(frame_.layout().header.offset_to_points + kLazOffsetBytes),
        batch_bytes_(std::size_t{laz_.chunk_points()} * encoder_.record_bytes_out() *
                     chunks_at_once(plan.encoder_bytes, encoder_.record_bytes_out(), thread_count())) {
    bytes_written_ = frame_.bytes_written();
    warnings_ = frame_.layout().warnings;
  }

  void write(std::span<const std::byte> records) override {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    assert(records.size() % in == 0 && "records come whole");
    for (std::size_t rows = records.size() / in, done = 0; done < rows;) {
      const std::size_t held = batch_.size(), n = std::min(rows - done, (batch_bytes_ - held) / out);
      batch_.resize(held + n * out);
      encode_rows(encoder_, frame_.layout().header.point_format, statistics_.count(), records.data() + done * in,
                  batch_.data() + held, n, statistics_);
      done += n;
      if (batch_.size() == batch_bytes_) compress_batch();
    }
  }

  void finish() override {
    frame_.require_count(statistics_.count());
    compress_batch();
    std::byte table_at[kLazOffsetBytes];
    std::memcpy(table_at, &at_, sizeof table_at);
    frame_.put(frame_.layout().header.offset_to_points, table_at);
    const std::vector<std::byte> table = laz_.write_chunk_table(chunks_);
    frame_.put(at_, table);
    if (std::string rounding = encoder_.rounding(); !rounding.empty()) add_warning(std::move(rounding));
    frame_.finish(statistics_, at_ + table.size());
    bytes_written_ = frame_.bytes_written();
  }

 private:
  void compress_batch() {
    const std::size_t chunk = std::size_t{laz_.chunk_points()} * encoder_.record_bytes_out();
    std::vector<std::vector<std::byte>> compressed((batch_.size() + chunk - 1) / chunk);
    parallel_for(compressed.size(), [&](std::size_t i, unsigned) {
      stop_if_cancelled();
      const std::span<const std::byte> rest = std::span<const std::byte>(batch_).subspan(i * chunk);
      compressed[i] = laz_.compress(rest.first(std::min(chunk, rest.size())));
    });
    for (const std::vector<std::byte>& bytes : compressed) {
      frame_.put(at_, bytes);
      chunks_.push_back({0, bytes.size()});
      at_ += bytes.size();
    }
    batch_.clear();
    bytes_written_ = frame_.bytes_written();
  }

  LasFrame frame_;
  const LazLayout& laz_;
  LasEncoder encoder_;
  LasStatistics statistics_;
  std::uint64_t at_;  ///< offset of the next chunk
  std::size_t batch_bytes_;
  std::vector<std::byte> batch_;  ///< records that are not compressed yet
  std::vector<LazLayout::ChunkSize> chunks_;
};

}  // namespace

std::uint64_t laz_encoder_bytes(std::uint64_t record_bytes, unsigned threads) {
  return chunks_at_once(0, record_bytes, threads) * chunk_bytes(record_bytes);
}

std::unique_ptr<Writer> create_laz_writer(const OutputPlan& plan) { return std::make_unique<LazWriter>(plan); }

}  // namespace pointsweep
