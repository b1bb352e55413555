// SPDX-License-Identifier: MIT
/// The writers of LAS and LAZ.
#include <algorithm>
#include <cassert>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_frame.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Bytes that a thread encodes, or reads back, at a time.
constexpr std::size_t kBlockBytes = std::size_t{256} << 10;

class LasWriter final : public LasFamilyWriter {
 public:
  explicit LasWriter(const OutputPlan& plan) : LasFamilyWriter(plan, LasPoints::plain) {}

  void write(std::span<const std::byte> records) override {
    write_at(next_row_, records);
    next_row_ += records.size() / encoder_.record_bytes_in();
  }

  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    const std::size_t rows = records.size() / in;
    assert(records.size() % in == 0 && "records come whole");
    if (row > frame_.planned() || rows > frame_.planned() - row) frame_.fail_since_more_came();
    const std::size_t block = std::max<std::size_t>(1, kBlockBytes / out);
    const LasStatistics none(header().point_format);
    std::vector<LasStatistics> of_blocks((rows + block - 1) / block, none);
    rooms_.resize(std::max<std::size_t>(rooms_.size(), thread_count()));
    parallel_for_blocks(rows, block, [&](std::size_t first, std::size_t n, unsigned worker) {
      std::span<const std::byte> encoded = records.subspan(first * in, n * in);
      if (!encoder_.is_identity()) {
        std::vector<std::byte>& room = rooms_[worker];
        room.resize(n * out);
        encoder_.run(row + first, encoded.data(), room.data(), n);
        encoded = room;
      }
      of_blocks[first / block].add(encoded.data(), out, n);
      frame_.put(place_of(row + first), encoded);
    });
    for (const LasStatistics& some : of_blocks) statistics_.add(some);
    bytes_written_ = frame_.bytes_written();
  }

  void finish() override {
    // A surplus means that some rows were written twice. Reading the file back counts each row once.
    if (statistics_.count() > frame_.planned()) read_back();
    frame_.require_count(statistics_.count());
    finish_file(frame_.layout().points_end(frame_.planned()));
  }

 private:
  std::uint64_t place_of(std::uint64_t row) const {
    return header().offset_to_points + row * encoder_.record_bytes_out();
  }

  void read_back() {
    statistics_ = LasStatistics(header().point_format);
    const std::size_t stride = encoder_.record_bytes_out();
    const std::size_t block = std::max<std::size_t>(1, kBlockBytes / stride);
    std::vector<std::byte> records;
    for (std::uint64_t row = 0; row < frame_.planned();) {
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(block, frame_.planned() - row));
      records.resize(n * stride);
      frame_.file().read_at(place_of(row), records);
      statistics_.add(records.data(), stride, n);
      row += n;
    }
  }

  std::vector<std::vector<std::byte>> rooms_;  ///< encoded records of each thread
  std::uint64_t next_row_ = 0;
};

/// Number of chunks that are compressed at once even if memory is at its minimum. A chunk takes about 5 MB: 2 MB of
/// records, 1 MB of compressed bytes and 2 MB for the coder (chunk_bytes()).
constexpr unsigned kFewChunksAtOnce = 4;

/// Returns the memory for compressing a chunk of records of `record_bytes`.
std::uint64_t chunk_bytes(std::uint64_t record_bytes) {
  constexpr std::uint64_t kModels = 2 << 20;  // models of the entropy coder, estimated from the peak memory of runs
  const std::uint64_t chunk = kLazChunkPoints * record_bytes;
  return chunk + chunk / 2 + kModels;
}

/// Returns how many chunks are compressed at once: one per thread, as far as `bytes` of memory allow, but at least
/// kFewChunksAtOnce if there are as many threads.
unsigned chunks_at_once(std::uint64_t bytes, std::uint64_t record_bytes, unsigned threads) {
  const std::uint64_t fitting = std::max<std::uint64_t>(bytes / chunk_bytes(record_bytes), kFewChunksAtOnce);
  return static_cast<unsigned>(std::clamp<std::uint64_t>(threads, 1, fitting));
}

class LazWriter final : public LasFamilyWriter {
 public:
  explicit LazWriter(const OutputPlan& plan)
      : LasFamilyWriter(plan, LasPoints::compressed),
        laz_(*frame_.layout().laz),
        at_(header().offset_to_points + kLazOffsetBytes),
        batch_bytes_(std::size_t{laz_.chunk_points()} * encoder_.record_bytes_out() *
                     chunks_at_once(plan.encoder_bytes, encoder_.record_bytes_out(), thread_count())) {}

  void write(std::span<const std::byte> records) override {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    assert(records.size() % in == 0 && "records come whole");
    for (std::size_t rows = records.size() / in, done = 0; done < rows;) {
      const std::size_t held = batch_.size(), n = std::min(rows - done, (batch_bytes_ - held) / out);
      batch_.resize(held + n * out);
      encode(records.data() + done * in, batch_.data() + held, n);
      done += n;
      if (batch_.size() == batch_bytes_) compress_batch();
    }
  }

  void finish() override {
    frame_.require_count(statistics_.count());
    compress_batch();
    finish_file(put_chunk_table(at_, chunks_));
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

  const LazLayout& laz_;
  std::uint64_t at_;  ///< offset of the next chunk
  std::size_t batch_bytes_;
  std::vector<std::byte> batch_;  ///< records that are not compressed yet
  std::vector<LazLayout::ChunkSize> chunks_;
};

}  // namespace

StoredCoordinate las_stored_coordinate(const OutputPlan& plan) {
  const LasLayout layout = lay_out_las(plan);
  if (!layout.positions_change) return {};
  return [scale = layout.header.scale, offset = layout.header.offset](std::size_t axis, double value) {
    const int a = static_cast<int>(axis);
    const Field step{.name = {}, .type = Type::i32, .scale = scale[a], .bias = offset[a]};
    std::byte steps[sizeof(std::int32_t)];
    set_value(step, steps, value);
    return value_of(step, steps);
  };
}

std::unique_ptr<Writer> create_las_writer(const OutputPlan& plan) { return std::make_unique<LasWriter>(plan); }

std::uint64_t laz_encoder_bytes(std::uint64_t record_bytes, unsigned threads) {
  return chunks_at_once(0, record_bytes, threads) * chunk_bytes(record_bytes);
}

std::unique_ptr<Writer> create_laz_writer(const OutputPlan& plan) { return std::make_unique<LazWriter>(plan); }

}  // namespace pointsweep
