// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cassert>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_frame.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Bytes that a thread encodes, or reads back, at a time.
constexpr std::size_t kBlockBytes = std::size_t{256} << 10;

class LasWriter : public Writer {
 public:
  explicit LasWriter(const OutputPlan& plan)
      : path_(plan.path.string()),
        planned_(plan.count),
        frame_(plan, LasPoints::plain),
        encoder_(frame_.layout(), path_),
        statistics_(frame_.layout().header.point_format) {
    bytes_written_ = frame_.bytes_written();
    warnings_ = frame_.layout().warnings;
  }

  void write(std::span<const std::byte> records) override {
    encode(next_row_, records);
    next_row_ += records.size() / encoder_.record_bytes_in();
  }

  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override { encode(row, records); }

  void finish() override {
    // A surplus means that some rows were written twice. Reading the file back counts each row once.
    if (statistics_.count() > planned_) read_back();
    frame_.require_count(statistics_.count());
    if (std::string rounding = encoder_.rounding(); !rounding.empty()) add_warning(std::move(rounding));
    frame_.finish(statistics_, frame_.layout().points_end(planned_));
    bytes_written_ = frame_.bytes_written();
  }

 private:
  void encode(std::uint64_t row, std::span<const std::byte> records) {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    const std::size_t rows = records.size() / in;
    assert(records.size() % in == 0 && "records come whole");
    if (row > planned_ || rows > planned_ - row) {
      fail("{}: {} points were announced, but more came; nothing was written.", path_, planned_);
    }
    const std::size_t block = std::max<std::size_t>(1, kBlockBytes / out);
    const LasStatistics none(frame_.layout().header.point_format);
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

  std::uint64_t place_of(std::uint64_t row) const {
    return frame_.layout().header.offset_to_points + row * encoder_.record_bytes_out();
  }

  void read_back() {
    statistics_ = LasStatistics(frame_.layout().header.point_format);
    const std::size_t stride = encoder_.record_bytes_out();
    const std::size_t block = std::max<std::size_t>(1, kBlockBytes / stride);
    std::vector<std::byte> records;
    for (std::uint64_t row = 0; row < planned_;) {
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(block, planned_ - row));
      records.resize(n * stride);
      frame_.file().read_at(place_of(row), records);
      statistics_.add(records.data(), stride, n);
      row += n;
    }
  }

  std::string path_;
  std::uint64_t planned_;
  LasFrame frame_;
  LasEncoder encoder_;
  LasStatistics statistics_;
  std::vector<std::vector<std::byte>> rooms_;  ///< encoded records of each thread
  std::uint64_t next_row_ = 0;
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

}  // namespace pointsweep
