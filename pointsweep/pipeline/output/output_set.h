// SPDX-License-Identifier: MIT
/// The outputs of all points of a run, or of one of its tiles (tile_set.h): a point file or the files of a division,
/// arrays, and a writer of the caller. They are opened, filled in the order of the rows, and completed.
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/records/write_behind.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/output/divided_writer.h"
#include "pointsweep/pipeline/output/output_formats.h"
#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/pipeline/plan/output_layout.h"

namespace pointsweep {

/// The parts of an OutputPlan, and the memory of a division, that a run decides: values that formats need before the
/// first record, memory, scratch files and progress.
struct OutputPlace {
  std::optional<Box> bounds;                           ///< OutputPlan::bounds
  std::shared_ptr<const KnownValues> values;           ///< OutputPlan::values
  std::uint64_t encoder_bytes = 0;                     ///< OutputPlan::encoder_bytes
  std::uint64_t division_bytes = 0;                    ///< DivisionRoom::bytes
  MakeScratch scratch = {};                            ///< OutputPlan::scratch
  std::function<void(std::uint64_t)> completing = {};  ///< OutputPlan::progress
};

/// Returns the layout of the records of an output. Throws UsageError if options.positions is set for a format that
/// stores coordinates as integers. Without options.positions, moved positions are passed to every format as float64; a
/// format that stores integers rounds them once.
OutputLayout layout_of_output(const InputCloud& cloud, const OutputNames& names, const Outputs& outputs,
                              const EngineOptions& options);

/// Returns the plan of an output whose records have the schema `records`. `provenance`: see OutputSet().
OutputPlan plan_of_output(const InputCloud& cloud, const Schema& records, const OutputNames& names,
                          const Outputs& outputs, const EngineOptions& options, OutputPlace place,
                          std::vector<std::string> provenance);

class OutputSet {
 public:
  /// Opens the outputs. Throws for unknown formats, existing files, missing folders, and arrays of attributes that the
  /// chain does not make. `provenance` is OutputPlan::provenance.
  OutputSet(const InputCloud& cloud, const OutputNames& names, const Outputs& outputs, const EngineOptions& options,
            OutputPlace place, std::vector<std::string> provenance = {});

  const OutputLayout& layout() const { return layout_; }
  /// Returns the warnings of the writers of points, and the sentence of FloatRounding. Must be called after finish().
  std::vector<std::string> warnings() const;
  /// Writes the next rows in input order, from `first_row` on: joins the results to these rows of the cloud, and writes
  /// the arrays. Writes nothing if the chain makes no attributes.
  void write_results(InputCloud& cloud, std::uint64_t first_row, std::span<const std::byte> results);
  /// Writes the next whole records of layout().
  void write_records(std::span<const std::byte> records);
  /// Writes records of the input without made attributes. `first_row` is the first of their rows, for messages.
  void write_inputs(std::uint64_t first_row, std::span<const std::byte> records);
  /// Writes records like write_inputs(), but at once if no earlier records are still being collected into a larger
  /// piece. `records` has unspecified content afterwards.
  void write_piece(std::uint64_t first_row, std::vector<std::byte>& records);
  /// Waits until the writers have taken all rows written so far.
  void flush();
  /// Completes the files and renames them to their destinations. Throws Error if an input has changed.
  void finish(const InputCloud& cloud);
  std::uint64_t bytes_written() const;
  /// Returns the number of complete point files, a writer of the caller counted as one. Must be called after finish().
  std::size_t files_written() const;

 private:
  struct Array {
    WriteBehind file;
    std::size_t offset, bytes;  ///< position and size of the attribute in a result record
    std::vector<std::byte> column;
  };
  std::size_t chunk_rows() const;
  void assemble_inputs(std::uint64_t first_row, std::span<const std::byte> records, std::vector<std::byte>& to) const;
  void write_filled();
  void write_assembled();

  OutputLayout layout_;
  std::uint32_t input_stride_;
  FloatRounding rounding_;
  std::filesystem::path name_;  ///< name of the output in messages; empty if the output is not a file
  std::size_t result_bytes_ = 0;
  WriteBehind points_;
  const DividedWriter* divided_ = nullptr;  ///< writer in points_ that divides the output; null if none does
  std::deque<Array> arrays_;
  std::optional<ParallelRows> input_rows_;  ///< reads rows of the cloud; made with the first results
  std::vector<std::byte> inputs_;
  std::vector<std::byte> assembled_;  ///< output records of the next chunk
  std::size_t filled_ = 0;            ///< bytes of assembled_ that write_records() has filled
};

}  // namespace pointsweep
