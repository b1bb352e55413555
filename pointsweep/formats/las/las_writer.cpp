// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_writer.h"

#include <algorithm>
#include <cassert>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/files/output_file.h"
#include "pointsweep/formats/las/las_encoder.h"
#include "pointsweep/formats/las/las_layout.h"
#include "pointsweep/formats/las/las_statistics.h"

namespace pointsweep {
namespace {

/// Bytes copied, encoded or read back at a time.
constexpr std::size_t kBlockBytes = std::size_t{1} << 20;

class LasWriter : public Writer {
 public:
  explicit LasWriter(const OutputPlan& plan)
      : path_(plan.path.string()),
        planned_(plan.count),
        extras_(plan.extras),
        layout_(lay_out_las(plan)),
        encoder_(layout_, path_),
        statistics_(layout_.header.point_format),
        out_(plan.path, plan.overwrite) {
    const LasHeader& header = layout_.header;
    put(0, serialize(header));
    std::uint64_t at = copy(layout_.before, header.header_size);
    put(at, layout_.added_vlrs);
    at = copy(layout_.between, at + layout_.added_vlrs.size());
    put(at, layout_.provenance_vlrs);
    copy(layout_.after, at + layout_.provenance_vlrs.size());
    warnings_ = layout_.warnings;
  }

  void write(std::span<const std::byte> records) override {
    encode(next_row_, records);
    next_row_ += records.size() / encoder_.record_bytes_in();
  }

  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override { encode(row, records); }

  void finish() override {
    if (statistics_.count() < planned_) fail_count();
    // More than planned: some rows were written again, and only a second look can count them once.
    if (statistics_.count() > planned_) read_back();
    copy(layout_.tail, layout_.points_end(planned_));
    statistics_.put_into(layout_.header);
    put(0, serialize(layout_.header));
    out_.commit();
  }

 private:
  void put(std::uint64_t at, std::span<const std::byte> bytes) {
    out_.write_at(at, bytes);
    bytes_written_ += bytes.size();
  }

  /// Copies a piece of the input to byte `to` of the output and returns the byte behind it.
  std::uint64_t copy(const LasPiece& piece, std::uint64_t to) {
    for (std::uint64_t from = piece.begin; from < piece.end;) {
      scratch_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBlockBytes, piece.end - from)));
      layout_.input->read_at(from, scratch_);
      put(to, scratch_);
      from += scratch_.size();
      to += scratch_.size();
    }
    return to;
  }

  [[noreturn]] void fail_count() const {
    fail("{}: {} points were announced, but {} came; nothing was written.", path_, planned_, statistics_.count());
  }

  void encode(std::uint64_t row, std::span<const std::byte> records) {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    std::size_t rows = records.size() / in;
    assert(records.size() % in == 0 && "records come whole");
    if (row > planned_ || rows > planned_ - row) {
      fail("{}: {} points were announced, but more came; nothing was written.", path_, planned_);
    }
    if (encoder_.is_identity()) return store(row, records, rows);
    const std::size_t block = std::max<std::size_t>(1, kBlockBytes / out);
    for (const std::byte* from = records.data(); rows != 0;) {
      const std::size_t n = std::min(block, rows);
      scratch_.resize(n * out);
      encoder_.run(row, from, scratch_.data(), n);
      store(row, scratch_, n);
      row += n;
      from += n * in;
      rows -= n;
    }
  }

  /// Takes finished LAS records.
  void store(std::uint64_t row, std::span<const std::byte> records, std::size_t rows) {
    statistics_.add(records.data(), encoder_.record_bytes_out(), rows);
    put(layout_.header.offset_to_points + row * encoder_.record_bytes_out(), records);
  }

  void read_back() {
    statistics_ = LasStatistics(layout_.header.point_format);
    const std::size_t stride = encoder_.record_bytes_out();
    const std::size_t block = std::max<std::size_t>(1, kBlockBytes / stride);
    for (std::uint64_t row = 0; row < planned_;) {
      const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(block, planned_ - row));
      scratch_.resize(n * stride);
      out_.read_at(layout_.header.offset_to_points + row * stride, scratch_);
      statistics_.add(scratch_.data(), stride, n);
      row += n;
    }
  }

  std::string path_;
  std::uint64_t planned_;
  std::shared_ptr<const FormatExtras> extras_;
  LasLayout layout_;
  LasEncoder encoder_;
  LasStatistics statistics_;
  OutputFile out_;
  std::vector<std::byte> scratch_;
  std::uint64_t next_row_ = 0;
};

}  // namespace

std::unique_ptr<Writer> create_las_writer(const OutputPlan& plan) { return std::make_unique<LasWriter>(plan); }

}  // namespace pointsweep
