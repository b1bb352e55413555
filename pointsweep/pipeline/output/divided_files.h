// SPDX-License-Identifier: MIT
/// The files of an output that is divided among many.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/pipeline/output/divider.h"
#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Throws Error if one of the files cannot be written, e.g. because it exists and may not be overwritten.
void require_files_possible(const Divider& divider, std::span<const DividedFile> files);

/// Writes the files of a divided output: large files one after another, several small files in parallel. Each file has
/// the layout of the whole output (one grid, one header except for counts and bounds). A file is complete or absent. A
/// tile that has no point inside its square, only points of its buffer (divider.h), is not written.
class DividedFiles {
 public:
  /// Borrows the divider and the files. `memory_bytes`: DivisionRoom::bytes, of which at most a quarter holds small
  /// files that wait to be written. `progress` gets the share of the records that are written or about to be written;
  /// it may be empty, and may throw.
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
  /// A small file whose records wait to be written in parallel with others.
  struct Waiting {
    std::uint32_t file;
    std::vector<std::byte> records;
  };
  std::string state() const;
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

}  // namespace pointsweep
