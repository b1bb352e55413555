// SPDX-License-Identifier: MIT
/// Writes an output that is divided among many files (Divider): collects the records file by file, in memory or in
/// scratch, then writes the files.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "pointsweep/pipeline/output/divider.h"
#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/run.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Collects records in any order and returns them group by group. When the memory is full, the records in it are sorted
/// by group and written to scratch as a run. At the end, all runs are read at the same time, each in sequence. So each
/// record is written and read once, for any number of groups; nothing is written if all records fit in memory.
class GroupedRecords {
 public:
  /// `expected`: about the number of records; the first record reserves memory for so many, or for a full run.
  /// `memory_bytes`: limit for the records in memory, without a piece of about a megabyte; for_each() uses at least 4
  /// kB, or one record, for each run.
  GroupedRecords(std::size_t record_bytes, std::uint64_t expected, std::uint64_t memory_bytes,
                 MakeScratch make_scratch);

  /// Appends a record to a group. Returns its place, which the caller fills before the next call.
  std::byte* add(std::uint32_t group);
  /// Calls `use` with whole records: groups in ascending order, records of a group in the order in which they came, in
  /// pieces of at most a megabyte, or of one larger record. Must be called once, after the last record.
  void for_each(const std::function<void(std::uint32_t group, std::span<const std::byte> records)>& use);

 private:
  using Use = std::function<void(std::uint32_t group, std::span<const std::byte> records)>;
  class Run;
  void put_run_aside();
  void for_each_held(const Use& use) const;
  std::size_t held() const { return group_of_.size(); }

  std::size_t record_bytes_;
  std::uint64_t expected_;
  std::size_t capacity_;  ///< number of records in a full run
  std::uint64_t memory_bytes_;
  MakeScratch make_scratch_;
  std::vector<std::byte> records_;       ///< records of the run that is being filled
  std::vector<std::uint32_t> group_of_;  ///< group of each record in records_
  std::unique_ptr<Scratch> scratch_;     ///< null until a run is written
  std::vector<std::uint64_t> run_ends_;  ///< offset in the scratch where each run ends
};

/// Throws Error if one of the files with points outside of their buffer cannot be written, e.g. because it exists and
/// may not be overwritten.
void require_files_possible(const Divider& divider, std::span<const DividedFile> files);

/// Writes the files of a divided output: large files one after another, several small files in parallel. Each file has
/// the layout of the whole output (one grid, one header except for counts and bounds). A file is complete or absent. A
/// tile that has no point inside its square, only points of its buffer (divider.h), is not written.
class DividedFiles {
 public:
  /// Borrows the divider and the files. `memory_bytes`: DivisionRoom::bytes, of which at most a quarter holds small
  /// files that wait to be written. `progress` gets the share of all records, from 0 to 1, that take() has received; it
  /// may be empty, and may throw.
  DividedFiles(const Divider& divider, const std::vector<DividedFile>& files, std::uint64_t memory_bytes,
               std::function<void(double share)> progress);

  /// Takes the next records of a file. All records of a file must come before the first record of another file.
  void take(std::uint32_t file, std::span<const std::byte> records);
  /// Completes the files. Must be called once, after the last record.
  void finish();

  std::size_t complete() const { return complete_; }  ///< number of complete files
  std::uint64_t bytes_written() const { return bytes_written_; }
  /// Returns sentences about the files for the user. Must be called after finish().
  std::vector<std::string> warnings() const;

 private:
  /// A small file whose records wait to be written in parallel with other small files.
  struct Waiting {
    std::uint32_t file;
    std::vector<std::byte> records;
  };
  std::string state() const { return complete_outputs_text(complete_, files_with_points(files_)); }
  void begin(std::uint32_t number);
  void put(std::uint32_t number, std::span<const std::byte> records);
  void write_together();
  void complete_large(std::uint32_t number);

  const Divider& divider_;
  const std::vector<DividedFile>& files_;
  std::uint64_t most_waiting_;
  std::function<void(double share)> progress_;
  ManyOutputs outputs_;
  std::vector<Waiting> waiting_;
  std::uint64_t waiting_bytes_ = 0;
  std::unique_ptr<Writer> large_;  ///< writer of a file whose records are written as they come
  std::uint64_t left_ = 0;         ///< records of the current file that have not come yet
  std::uint64_t taken_ = 0, all_ = 0;
  std::atomic<std::size_t> complete_ = 0;
  std::uint64_t bytes_written_ = 0;
  OutputWarnings warnings_;
};

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

/// Collects records file by file (DividedRecords). finish() then writes the files (DividedFiles).
class DividedWriter final : public Writer {
 public:
  /// Throws the errors of Divider() and of create_writer().
  DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room);

  void write(std::span<const std::byte> records) override { records_.write(records); }
  void finish() override;
  std::size_t files() const { return complete_; }  ///< number of complete files

 private:
  void warn_of_other_files();

  std::function<void(std::uint64_t points)> progress_;  ///< OutputPlan::progress of all files together
  Divider divider_;
  DivisionRoom room_;
  DividedRecords records_;
  std::size_t complete_ = 0;
};

}  // namespace pointsweep
