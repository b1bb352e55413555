// SPDX-License-Identifier: MIT
/// A writer of COPC: LAZ whose chunks are the nodes of an octree, the coarsest first.
#include <algorithm>
#include <cassert>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/las/copc_layout.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_frame.h"
#include "pointsweep/formats/las/laz_codec.h"
#include "pointsweep/levels/level_choice.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// Number of rows that are encoded at once.
constexpr std::size_t kBatchOfRows = 64 << 10;

/// The least memory of a writer beyond least_level_bytes().
constexpr std::uint64_t kLeastNodeBytes = 16 << 20;
/// Memory beyond the minimum with which files of up to 3 GB are written faster; larger files use more.
constexpr std::uint64_t kUsefulBytes = 96 << 20;
/// Number of copies of a node that are in memory while the node is sorted and compressed.
constexpr std::uint64_t kCopiesOfNode = 3;
/// Largest size of a node of a writer that keeps all points in memory: nodes may have any size.
constexpr std::uint64_t kAnyNumberOfBytes = ~std::uint64_t{0};

/// Returns the memory that a writer of records of `bytes` bytes in total uses: `memory`, but at least the minimum, and
/// at most the amount beyond which the writer gets no faster.
std::uint64_t useful_memory(std::uint64_t bytes, std::uint64_t memory, unsigned threads) {
  const std::uint64_t least = copc_encoder_bytes(0, threads);
  return std::clamp(memory, least, least + std::max(kUsefulBytes, bytes / 32));
}

/// Returns the part of the memory for records and their levels. Nodes that wait to be compressed take the rest.
std::uint64_t record_memory(std::uint64_t memory) { return memory / 4 * 3; }

OutputPlan with_copc_layout(OutputPlan plan) {
  plan.layout = copc_file_layout(plan.schema, std::move(plan.layout), plan.path.string());
  return plan;
}

class CopcWriter final : public LasFamilyWriter {
 public:
  explicit CopcWriter(const OutputPlan& plan)
      : LasFamilyWriter(plan, LasPoints::nodes),
        path_(plan.path.string()),
        progress_(plan.progress),
        memory_(useful_memory(plan.count * encoder_.record_bytes_out(), plan.encoder_bytes, thread_count())),
        most_node_bytes_(plan.scratch ? std::max(memory_, plan.encoder_bytes) / kCopiesOfNode : kAnyNumberOfBytes),
        records_(encoder_.record_bytes_out(), record_memory(memory_), plan.scratch) {}

  void write(std::span<const std::byte> records) override {
    const std::size_t in = encoder_.record_bytes_in(), out = encoder_.record_bytes_out();
    assert(records.size() % in == 0 && "records come whole");
    for (std::size_t rows = records.size() / in, done = 0; done < rows;) {
      const std::size_t n = std::min(rows - done, kBatchOfRows);
      batch_.resize(n * out);
      encode(records.data() + done * in, batch_.data(), n);
      records_.add(batch_);
      done += n;
    }
  }

  void finish() override {
    frame_.require_count(statistics_.count());
    if (progress_) progress_(0);
    records_.choose(header().scale);
    const std::size_t record_bytes = encoder_.record_bytes_out();
    CopcNodes nodes(*frame_.layout().laz, record_bytes, memory_ / 4, most_node_bytes_,
                    records_.room().make(statistics_.count() * record_bytes / 4), path_);
    std::uint64_t added = 0;
    records_.for_each([&](const CurveKey& key, int depth, const std::byte* record) {
      nodes.add(key, depth, record);
      if (++added % kBatchOfRows == 0 && progress_) progress_(added);
    });
    const std::vector<CopcNode> chunks =
        nodes.finish(first_chunk(), [&](std::uint64_t at, std::span<const std::byte> bytes) {
          frame_.put(at, bytes);
          bytes_written_ = frame_.bytes_written();
        });
    if (progress_) progress_(added);  // may throw, and so is called before the file is complete
    write_after_points(chunks, nodes.times());
  }

 private:
  /// Writes the chunk table, the hierarchy, the info VLR and the header.
  void write_after_points(const std::vector<CopcNode>& nodes, TimeRange times) {
    std::vector<LazLayout::ChunkSize> chunks;
    std::uint64_t at = first_chunk();
    for (const CopcNode& node : nodes) {
      chunks.push_back({node.points, node.bytes});
      at += node.bytes;
    }
    at = put_chunk_table(at, chunks);
    const std::vector<std::byte> hierarchy = copc_hierarchy_bytes(nodes);
    frame_.put(header().header_size + kLasVlrHeader,
               copc_info_bytes(info_of(times, at + frame_.tail_bytes() + kLasEvlrHeader, hierarchy.size())));
    finish_file(at, las_evlr(kCopcUser, kCopcHierarchyRecord, "COPC hierarchy", hierarchy));
  }

  CopcInfo info_of(TimeRange times, std::uint64_t root_offset, std::uint64_t root_bytes) const {
    const LevelGrid& grid = records_.grid();
    const double half = grid.width() * grid.unit() / 2;
    return {.center = grid.corner(header().offset) + Vec3{half, half, half},
            .half_size = half,
            .spacing = records_.spacing(),
            .root_offset = root_offset,
            .root_bytes = root_bytes,
            .least_time = times.least,
            .greatest_time = times.greatest};
  }

  std::uint64_t first_chunk() const { return header().offset_to_points + kLazOffsetBytes; }

  std::string path_;
  std::function<void(std::uint64_t points)> progress_;  ///< may be empty
  std::uint64_t memory_, most_node_bytes_;
  LevelledRecords records_;
  std::vector<std::byte> batch_;  ///< encoded records
};

}  // namespace

std::uint64_t copc_encoder_bytes(std::uint64_t, unsigned threads) {
  return kLeastNodeBytes + least_level_bytes(threads);
}

// If records are put aside, the scratch holds the record and the grid point of each point; two more grid points and a
// number for each point that is kept at a depth before the last (at most a third of all points); and the compressed
// chunks, counted as half of the records.
std::uint64_t copc_aside_bytes(std::uint64_t count, std::uint64_t record_bytes, std::uint64_t memory,
                               unsigned threads) {
  constexpr std::uint64_t kPlace = sizeof(GridPoint);
  const std::uint64_t bytes = count * record_bytes;
  if (!puts_records_aside(bytes, record_memory(useful_memory(bytes, memory, threads)))) return 0;
  return bytes + bytes / 2 + count * (kPlace + (2 * kPlace + sizeof(std::uint64_t)) / 3);
}

KnownValues copc_values(InputCloud& cloud, const FileLayout& layout,
                        const std::function<void(std::uint64_t)>& progress) {
  return las_values(cloud, copc_file_layout(cloud.schema(), layout, "COPC"), progress);
}

bool copc_values_need_points(const InputCloud& cloud, const FileLayout& layout) {
  return las_values_need_points(cloud, copc_file_layout(cloud.schema(), layout, "COPC"));
}

StoredCoordinate copc_stored_coordinate(const OutputPlan& plan) {
  return las_stored_coordinate(with_copc_layout(plan));
}

std::unique_ptr<Writer> create_copc_writer(const OutputPlan& plan) {
  return std::make_unique<CopcWriter>(with_copc_layout(plan));
}

}  // namespace pointsweep
