// SPDX-License-Identifier: MIT
/// The files of a run, opened before the work and completed after it.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/records/write_behind.h"
#include "pointsweep/order/parallel_rows.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/output/divided_writer.h"
#include "pointsweep/pipeline/output/float_rounding.h"
#include "pointsweep/pipeline/plan/output_layout.h"

namespace pointsweep {

/// The values that formats need before the first record.
struct OutputPlace {
  std::optional<Box> bounds;                  ///< OutputPlan::bounds
  std::shared_ptr<const KnownValues> values;  ///< OutputPlan::values
  std::uint64_t encoder_bytes = 0;            ///< OutputPlan::encoder_bytes
  std::uint64_t division_bytes = 0;           ///< DivisionRoom::bytes
  MakeScratch scratch = {};                   ///< OutputPlan::scratch
  std::function<void(std::uint64_t)> completing = {};  ///< DivisionRoom::progress
};

class OutputSet {
 public:
  /// Refuses before any work: unknown formats, existing files, missing folders, names of attributes no operator makes.
  /// `made` and `kept` under the names they have in outputs (output_formats.h); `provenance` as in OutputPlan.
  OutputSet(const InputCloud& cloud, const std::vector<Attribute>& made, const KeptFields& kept, const Outputs& outputs,
            const EngineOptions& options, OutputPlace place, std::vector<std::string> provenance = {});

  const OutputLayout& layout() const { return layout_; }
  /// Returns one sentence for each thing that the formats of the files cannot hold.
  std::vector<std::string> warnings() const;
  /// The next rows in input order: reads the same rows of the cloud and puts the results to them.
  void write_results(InputCloud& cloud, std::uint64_t first_row, std::span<const std::byte> results);
  /// The next whole records of layout().
  void write_records(std::span<const std::byte> records);
  /// Appends records of the input without made attributes. They are rows from `first_row` on, for messages.
  void write_inputs(std::uint64_t first_row, std::span<const std::byte> records);
  /// Appends records like write_inputs(), as one piece that is large enough to be written by itself. The bytes that are
  /// left in `records` have no meaning.
  void write_piece(std::uint64_t first_row, std::vector<std::byte>& records);
  /// Returns when all rows that have come are in the files.
  void flush();
  /// Gives the files their names, unless the inputs have changed meanwhile.
  void finish(const InputCloud& cloud);
  std::uint64_t bytes_written() const;
  /// Returns the number of point files that are complete.
  std::size_t files_written() const;

 private:
  struct Array {
    WriteBehind file;
    std::size_t offset, bytes;  ///< in a result record
    std::vector<std::byte> column;
  };
  std::size_t chunk_rows() const;
  void assemble_inputs(std::uint64_t first_row, std::span<const std::byte> records, std::vector<std::byte>& to) const;
  void write_filled();
  void write_assembled();

  OutputLayout layout_;
  std::uint32_t input_stride_;
  FloatRounding rounding_;
  std::filesystem::path name_;  ///< of the output in sentences; empty: it is no file
  std::size_t result_bytes_ = 0;
  WriteBehind points_;
  const DividedWriter* divided_ = nullptr;  ///< one of points_
  std::deque<Array> arrays_;
  std::optional<ParallelRows> input_rows_;  ///< of the cloud, from the first results on
  std::vector<std::byte> inputs_;
  std::vector<std::byte> assembled_;  ///< output records of the next chunk
  std::size_t filled_ = 0;            ///< bytes of it that came by write_records()
};

}  // namespace pointsweep
