// SPDX-License-Identifier: MIT
/// Writing COPC: LAZ whose chunks are the nodes of an octree, the coarsest first.
#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/las/copc_layout.h"
#include "pointsweep/formats/las/copc_nodes.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_frame.h"
#include "pointsweep/formats/las/laz_layout.h"
#include "pointsweep/levels/levelled_records.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Rows that a thread encodes, and rows that are encoded at once.
constexpr std::size_t kEncodedRows = 4096, kBatchOfRows = 16 * kEncodedRows;

/// The least memory for nodes that wait to be compressed.
constexpr std::uint64_t kLeastNodeBytes = 16 << 20;
/// Memory beyond the least one that makes a small file faster.
constexpr std::uint64_t kUsefulBytes = 96 << 20;
/// Of a node, while it is sorted and compressed.
constexpr std::uint64_t kCopiesOfNode = 3, kAnyNumberOfBytes = ~std::uint64_t{0};

OutputPlan with_copc_layout(OutputPlan plan) {
  plan.layout = copc_file_layout(plan.schema, std::move(plan.layout), plan.path.string());
  return plan;
}

/// The least and the greatest GPS time; 0 for both where there is none.
class TimeRange {
 public:
  void add(const std::byte* records, std::size_t stride, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      double time;
      std::memcpy(&time, records + i * stride + kLasModernTimeAt, sizeof time);
      least_ = std::min(least_, time);
      greatest_ = std::max(greatest_, time);
    }
  }
  void add(const TimeRange& other) {
    least_ = std::min(least_, other.least_);
    greatest_ = std::max(greatest_, other.greatest_);
  }
  double least() const { return least_ <= greatest_ ? least_ : 0; }
  double greatest() const { return least_ <= greatest_ ? greatest_ : 0; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double least_ = kInfinity, greatest_ = -kInfinity;
};

class CopcWriter : public Writer {
 public:
  explicit CopcWriter(const OutputPlan& plan)
      : path_(plan.path.string()),
        frame_(plan, LasPoints::nodes),
        encoder_(frame_.layout(), path_),
        statistics_(frame_.layout().header.point_format),
        memory_(memory_of(plan, encoder_.record_bytes_out())),
        most_node_bytes_(plan.scratch ? std::max(memory_, plan.encoder_bytes) / kCopiesOfNode : kAnyNumberOfBytes),
        records_(encoder_.record_bytes_out(), memory_ / 4 * 3, plan.scratch) {
    bytes_written_ = frame_.bytes_written();
    warnings_ = frame_.layout().warnings;
  }

  void write(std::span<const std::byte> records) override {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    assert(records.size() % in == 0 && "records come whole");
    for (std::size_t rows = records.size() / in, done = 0; done < rows;) {
      const std::size_t n = std::min(rows - done, kBatchOfRows);
      batch_.resize(n * out);
      encode(records.data() + done * in, n);
      records_.add(batch_);
      done += n;
    }
  }

  void finish() override {
    frame_.require_count(statistics_.count());
    records_.choose(frame_.layout().header.scale);
    const std::size_t record_bytes = encoder_.record_bytes_out();
    CopcNodes nodes(*frame_.layout().laz, record_bytes, memory_ / 4, most_node_bytes_,
                    records_.room().make(statistics_.count() * record_bytes / 4), path_);
    records_.for_each([&](const CurveKey& key, int depth, const std::byte* record) { nodes.add(key, depth, record); });
    finish_file(nodes.finish(first_chunk(), [&](std::uint64_t at, std::span<const std::byte> bytes) {
      frame_.put(at, bytes);
      bytes_written_ = frame_.bytes_written();
    }));
  }

 private:
  /// More memory than this makes nothing faster where there is a temporary folder.
  static std::uint64_t memory_of(const OutputPlan& plan, std::uint64_t record_bytes) {
    const std::uint64_t least = copc_encoder_bytes(record_bytes, thread_count());
    const std::uint64_t useful = least + std::max(kUsefulBytes, plan.count * record_bytes / 32);
    return std::max(least, plan.scratch ? std::min(plan.encoder_bytes, useful) : plan.encoder_bytes);
  }

  void encode(const std::byte* from, std::size_t n) {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    const std::uint64_t row = statistics_.count();
    const std::size_t tasks = (n + kEncodedRows - 1) / kEncodedRows;
    std::vector<LasStatistics> statistics(tasks, LasStatistics(frame_.layout().header.point_format));
    std::vector<TimeRange> times(tasks);
    parallel_for_blocks(n, kEncodedRows, [&](std::size_t first, std::size_t rows, unsigned) {
      std::byte* const to = batch_.data() + first * out;
      encoder_.run(row + first, from + first * in, to, rows);
      statistics[first / kEncodedRows].add(to, out, rows);
      times[first / kEncodedRows].add(to, out, rows);
    });
    for (const LasStatistics& some : statistics) statistics_.add(some);
    for (const TimeRange& some : times) times_.add(some);
  }

  /// The chunk table, the hierarchy, the info VLR and the header.
  void finish_file(const std::vector<CopcNode>& nodes) {
    std::vector<LazLayout::ChunkSize> chunks;
    std::uint64_t at = first_chunk();
    for (const CopcNode& node : nodes) {
      chunks.push_back({node.points, node.bytes});
      at += node.bytes;
    }
    std::byte table_at[kLazOffsetBytes];
    std::memcpy(table_at, &at, sizeof table_at);
    frame_.put(frame_.layout().header.offset_to_points, table_at);
    const std::vector<std::byte> table = frame_.layout().laz->write_chunk_table(chunks);
    frame_.put(at, table);
    at += table.size();
    const std::vector<std::byte> hierarchy = copc_hierarchy_bytes(nodes);
    const LasHeader& header = frame_.layout().header;
    frame_.put(header.header_size + kLasVlrHeader,
               copc_info_bytes(info_of(header, at + frame_.tail_bytes() + kLasEvlrHeader, hierarchy.size())));
    if (std::string rounding = encoder_.rounding(); !rounding.empty()) add_warning(std::move(rounding));
    frame_.finish(statistics_, at, las_evlr(kCopcUser, kCopcHierarchyRecord, "COPC hierarchy", hierarchy));
    bytes_written_ = frame_.bytes_written();
  }

  CopcInfo info_of(const LasHeader& header, std::uint64_t root_offset, std::uint64_t root_bytes) const {
    const LevelGrid& grid = records_.grid();
    const double half = grid.width() * grid.step() / 2;
    return {.center = grid.corner(header.offset) + Vec3{half, half, half},
            .half_size = half,
            .spacing = records_.spacing(),
            .root_offset = root_offset,
            .root_bytes = root_bytes,
            .least_time = times_.least(),
            .greatest_time = times_.greatest()};
  }

  std::uint64_t first_chunk() const { return frame_.layout().header.offset_to_points + kLazOffsetBytes; }

  std::string path_;
  LasFrame frame_;
  LasEncoder encoder_;
  LasStatistics statistics_;
  TimeRange times_;
  std::uint64_t memory_, most_node_bytes_;
  LevelledRecords records_;
  std::vector<std::byte> batch_;  ///< encoded records
};

}  // namespace

std::uint64_t copc_encoder_bytes(std::uint64_t, unsigned threads) {
  return kLeastNodeBytes + least_level_bytes(threads);
}

// The record, its place, the points kept at all depths but the last (a third of all, at most) in lists and by number,
// and the compressed chunk.
std::uint64_t copc_aside_bytes(std::uint64_t record_bytes) {
  constexpr std::uint64_t kPlace = sizeof(GridPoint);
  return record_bytes + kPlace + (2 * kPlace + sizeof(std::uint64_t)) / 3 + record_bytes / 2;
}

KnownValues copc_values(InputCloud& cloud, const FileLayout& layout,
                        const std::function<void(std::uint64_t)>& progress) {
  return las_values(cloud, copc_file_layout(cloud.schema(), layout, "COPC"), progress);
}

StoredCoordinate copc_stored_coordinate(const OutputPlan& plan) {
  return las_stored_coordinate(with_copc_layout(plan));
}

std::unique_ptr<Writer> create_copc_writer(const OutputPlan& plan) {
  return std::make_unique<CopcWriter>(with_copc_layout(plan));
}

}  // namespace pointsweep
