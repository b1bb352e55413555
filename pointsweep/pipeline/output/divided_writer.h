// SPDX-License-Identifier: MIT
/// The records of an output that is divided among many files (Divider), collected file by file, and their writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "pointsweep/pipeline/output/divider.h"
#include "pointsweep/pipeline/output/grouped_records.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/run.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// The records of a divided output, collected file by file.
class DividedRecords {
 public:
  /// Borrows the divider. `expected`: number of records. `memory_bytes` and `make_scratch` are passed to
  /// GroupedRecords.
  DividedRecords(const Divider& divider, std::uint64_t expected, std::uint64_t memory_bytes, MakeScratch make_scratch);

  /// Adds records to their files, and to the files of tiles that have the points in their buffers. Throws the error of
  /// Divider::require_few().
  void write(std::span<const std::byte> records);
  /// Calls `use` with whole records of Divider::plan(), file by file, the records of a file in the order of write().
  /// `file` is an index of files(). Must be called once, after the last record.
  void for_each(const std::function<void(std::uint32_t file, std::span<const std::byte> records)>& use) {
    records_.for_each(use);
  }

  /// Returns the files in the order of their first records. A file may have only points of its buffer.
  const std::vector<DividedFile>& files() const { return files_; }
  std::uint64_t came() const { return came_; }  ///< number of records passed to write()

 private:
  void put(FileKey key, const std::byte* record, bool is_own);

  const Divider& divider_;
  GroupedRecords records_;
  std::vector<FileKey> keys_;  ///< files of the records of the last write()
  std::vector<DividedFile> files_;
  std::unordered_map<FileKey, std::uint32_t, FileKeyHash> file_of_;
  std::uint64_t came_ = 0;
  std::size_t with_points_ = 0;  ///< files with points outside of their buffer
};

/// Memory and scratch for the records that wait for their files.
struct DivisionRoom {
  std::uint64_t bytes = 0;   ///< memory, without the memory of the files' encoders
  MakeScratch scratch = {};  ///< for records that do not fit in memory
};

/// The least DivisionRoom::bytes.
inline constexpr std::uint64_t kLeastDivisionBytes = 16 << 20;

/// Collects records file by file (DividedRecords). After the last record it writes the files (DividedFiles).
class DividedWriter final : public Writer {
 public:
  /// Throws the errors of Divider() and of create_writer().
  DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room);

  void write(std::span<const std::byte> records) override { records_.write(records); }
  void finish() override;
  std::size_t files() const { return complete_; }  ///< number of complete files

 private:
  std::function<void(std::uint64_t points)> progress_;  ///< OutputPlan::progress of all files together
  Divider divider_;
  DivisionRoom room_;
  DividedRecords records_;
  std::size_t complete_ = 0;
};

}  // namespace pointsweep
