// SPDX-License-Identifier: MIT
/// An output that is divided among many files (Divider), as a writer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "pointsweep/pipeline/output/divided_records.h"
#include "pointsweep/pipeline/output/divider.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/run.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Memory and scratch for the records that wait for their files.
struct DivisionRoom {
  std::uint64_t bytes = 0;   ///< memory, without the memory of the files' encoders
  MakeScratch scratch = {};  ///< for records that do not fit in memory
};

/// The least DivisionRoom::bytes.
inline constexpr std::uint64_t kLeastDivisionBytes = 16 << 20;

/// Stores records in the order of their arrival (DividedRecords). After the last record it writes the files
/// (DividedFiles).
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
