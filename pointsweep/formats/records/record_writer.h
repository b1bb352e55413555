// SPDX-License-Identifier: MIT
/// Writers of files that consist of a header and records of a fixed size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"
#include "pointsweep/storage/local/output_file.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Throws Error if `rows` records from `row` on are more than the plan announces.
void require_announced(const OutputPlan& plan, std::uint64_t row, std::uint64_t rows);
/// Throws Error if only `rows_written` of the records that the plan announces came.
void require_all(const OutputPlan& plan, std::uint64_t rows_written);

/// Writes a file of a header and records. Each record of the plan is converted to the schema `stored`, block by block,
/// or copied if the schemas are equal. If the output is seekable, all threads write blocks at the same time.
class RecordWriter : public Writer {
 public:
  RecordWriter(const OutputPlan& plan, std::string_view header, const Schema& stored);

  void write(std::span<const std::byte> records) override;
  bool can_write_at() const override { return file_.is_seekable(); }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override;
  void finish() override;

 protected:
  /// Checks the records of one call of write_at(), as they come and before any of them is stored. May throw.
  virtual void check(std::uint64_t row, std::span<const std::byte> records) { (void)row, (void)records; }
  const OutputPlan& plan() const { return plan_; }

 private:
  void write_header();  ///< called after the first check(), so that standard output stays empty if it fails

  OutputPlan plan_;
  OutputFile file_;
  std::string header_;  ///< empty after it is written
  std::uint64_t header_bytes_;
  std::uint32_t stored_stride_;
  RecordConversion conversion_;
  std::vector<std::vector<std::byte>> converted_;  ///< converted records of each thread
  std::uint64_t rows_written_ = 0;                 ///< rows written by write() and write_at() together
};

}  // namespace pointsweep
