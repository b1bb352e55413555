// SPDX-License-Identifier: MIT
/// The implementation of a Cloud: several readers as one cloud, rows that are left out, decoders for several threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/cloud.h"
#include "pointsweep/formats/chosen_chunks.h"
#include "pointsweep/formats/cloud/common_schema.h"
#include "pointsweep/formats/cloud/reader_adapters.h"
#include "pointsweep/formats/cloud/row_selection.h"
#include "pointsweep/points/row_box.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/place.h"

namespace pointsweep {

/// The inputs of a run as one cloud; class Cloud documents its schema. The integer coordinates of LAS inputs are kept
/// if all lie on one grid (common_grid()). Class MissingFields defines the values of fields that an input lacks. Only
/// read(), place_of_row() and input_row() change an object, and only its reading state. Clouds with other rows or
/// fields of the same inputs are made by numbered(), with_chunks(), finite(), read_by() and selected(), in this order;
/// they share the readers.
class InputCloud {
 public:
  explicit InputCloud(const std::vector<std::filesystem::path>& paths, CloudOptions options = {});
  explicit InputCloud(std::vector<std::unique_ptr<Reader>> readers, CloudOptions options = {});
  explicit InputCloud(std::vector<std::shared_ptr<Reader>> readers, CloudOptions options = {});

  const Schema& schema() const { return schema_; }
  /// Returns the number of rows of all inputs, or of the selected rows.
  std::uint64_t count() const { return selection_ ? selection_->count() : count_; }
  const std::vector<std::shared_ptr<Reader>>& readers() const { return readers_; }
  /// Returns the extras of the first input; null if it has none.
  std::shared_ptr<const FormatExtras> extras() const;
  /// Returns the extras of the inputs after the first, without extras that are like earlier extras
  /// (OutputPlan::other_extras).
  std::vector<std::shared_ptr<const FormatExtras>> other_extras() const;
  /// Returns the coordinate reference system that the user states, or else the system that the first input with a
  /// system states.
  const std::optional<Crs>& crs() const { return crs_; }
  /// Returns CloudOptions::crs.
  const std::optional<StatedCrs>& stated_crs() const { return stated_crs_; }
  /// Returns whether crs() counts in place of another system that an input states.
  bool replaces_crs() const { return replaces_crs_; }
  /// Returns whether inputs may have different coordinate reference systems.
  bool ignores_crs() const { return ignores_crs_; }
  /// Returns the common origin of the inputs that are LAS or were made from LAS; null if there are no such inputs.
  const std::shared_ptr<const LasOrigin>& las() const { return las_; }
  /// Returns the range of each field that the types of the inputs allow.
  const std::vector<ValueRange>& ranges() const { return ranges_; }
  /// Returns sentences about harmless faults in the combination of inputs. FileInfo::warnings has those of one input.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Returns the warnings about inputs that lack attributes of other inputs, and about inputs whose 8-bit colours
  /// become 16-bit colours.
  const std::vector<std::string>& missing_attributes() const { return missing_attributes_; }
  /// Appends the boxes that files state for their points, in the order of the rows: boxes of chunks if a file states
  /// them, else the box of the whole file. Returns the first input with points that states no box, or null.
  const Reader* stated_boxes(std::vector<RowBox>& boxes) const;
  /// Returns the total size of all input files.
  std::uint64_t bytes() const;

  /// Reads records of all inputs like Reader::read. Not thread-safe.
  std::size_t read(std::uint64_t row, std::span<std::byte> records);

  /// Returns a decoder of rows for one thread; other threads may read at the same time. Null if an input has no
  /// decoders or very long chunks, so that only read() can read rows. Fields other than the `wanted` fields may have
  /// any value. *this must outlive the decoder. Thread-safe.
  std::unique_ptr<RowDecoder> decoder(const WantedFields& wanted = {}) const;
  /// Returns the row after the chunk that contains `row`, up to which one decoder should read. Returns `row` if rows
  /// may be split anywhere. Thread-safe.
  std::uint64_t chunk_end(std::uint64_t row) const;

  /// Returns the number of the input that has a row, and the number of the row in the file of this input, among all its
  /// rows. `row` is the number of the row before selection(). Not thread-safe.
  std::pair<std::size_t, std::uint64_t> place_of_row(std::uint64_t row);
  /// Returns, for each input, the number of rows of the cloud in the inputs before it, and as the last element the
  /// number of rows of the cloud. Rows that selection() leaves out do not count.
  std::vector<std::uint64_t> first_rows() const;
  /// Returns the number of a row among the rows of all input files, including rows that finite() or with_chunks()
  /// leaves out. `row` is the number of the row before selection(). Not thread-safe.
  std::uint64_t input_row(std::uint64_t row);

  /// Returns the selection; null if no rows are selected.
  const std::shared_ptr<const RowSelection>& selection() const { return selection_; }

  /// Returns the cloud of the chosen chunks, as if the inputs had no others. Inputs without decoders, and inputs whose
  /// rows may be split anywhere, keep all rows; the first chunk is kept if no point would be left.
  InputCloud with_chunks(const std::function<bool(const Chunk&)>& is_chosen) const;
  /// Returns the cloud whose records have one more field at the end: the number of the row in the inputs (input_row.h),
  /// which counts rows that are dropped later. The first row has the number `first`. A cloud with this field stays as
  /// it is.
  InputCloud numbered(std::uint64_t first = 0) const;
  /// Returns the cloud without the rows with NaN or infinite coordinates, and the dropped rows, numbered as in this
  /// cloud. NonfiniteRows::bounds is empty if an input with points was not read. Reads every input that can have such
  /// rows once; `progress` is called with the number of rows read.
  std::pair<InputCloud, NonfiniteRows> finite(const std::function<void(std::uint64_t rows)>& progress = {}) const;
  /// Returns the cloud that reads the same records by other readers, one for each input.
  InputCloud read_by(std::vector<std::shared_ptr<Reader>> readers) const;
  /// Returns the cloud for a run whose result does not depend on attributes of the cloud: integers that their common
  /// type does not hold are no error.
  InputCloud with_unused_attributes() const;
  /// Returns the cloud with only the rows that `selection` keeps, numbered from 0. The selection is of all rows of this
  /// cloud, including the rows that selection() leaves out.
  InputCloud selected(RowSelection selection) const;

  /// Returns the state of each input before it was opened, or, for a cloud of open readers, when the cloud was made.
  const std::vector<FileState>& states() const { return *states_; }
  /// Throws Error if an input has changed since it was opened: the data read may be a mixture of old and new.
  void require_unchanged() const;
  /// Throws Error if input `input` was written to since it was opened.
  void require_unchanged(std::size_t input) const;

 private:
  void begin(CloudOptions options);
  void take_common_schema();
  void count_rows();
  std::size_t input_of(std::uint64_t row) const;
  class Decoder;
  /// A function that reads rows of an input. The input has at least one row from `row` on.
  using ReadInput = std::function<std::size_t(std::size_t input, std::uint64_t row, std::span<std::byte> records)>;
  /// The state of reading rows one after another. A copy does not copy the state.
  struct Reading {
    Reading() = default;
    Reading(const Reading&) : Reading() {}
    Reading& operator=(const Reading&) { return *this = Reading(); }
    Reading(Reading&&) = default;
    Reading& operator=(Reading&&) = default;

    std::vector<std::byte> scratch;
    std::optional<SelectionCursor> cursor;
    std::size_t last_input = 0;  ///< input of the last read()
  };
  std::size_t read_with(const ReadInput& read, Reading& reading, std::uint64_t row, std::span<std::byte> records) const;
  std::size_t read_all_with(const ReadInput& read, std::vector<std::byte>& scratch, std::uint64_t row,
                            std::span<std::byte> records) const;
  std::size_t read_input(const ReadInput& read, std::vector<std::byte>& scratch, std::size_t input, std::uint64_t row,
                         std::span<std::byte> records) const;
  std::size_t checked(std::size_t input, std::uint64_t row, std::span<const std::byte> records,
                      const WantedFields& wanted, std::size_t rows) const;
  /// Returns the number in the file of row `row` of the input's reader, which may leave out rows of the file.
  /// Thread-safe if the reader has decoders.
  std::uint64_t row_in_file(std::size_t input, std::uint64_t row) const;
  /// Returns the number in the file of row `row` of the input's chosen chunks; `row` if all chunks are read.
  std::uint64_t chosen_row(std::size_t input, std::uint64_t row) const;

  // Clouds over the same inputs share states_, mappings_ and the readers, which take memory for each input.
  std::shared_ptr<const std::vector<FileState>> states_;  ///< see states()
  std::vector<std::shared_ptr<Reader>> readers_;
  /// For each input of which only chosen chunks are read, its reader, for the numbers of rows in the file; null for
  /// other inputs. Empty if all inputs are read completely.
  std::vector<std::shared_ptr<const ChosenChunks>> chosen_;
  std::vector<std::shared_ptr<FiniteRows>> finite_;
  std::vector<std::uint64_t> first_row_;
  std::shared_ptr<const std::vector<InputMapping>> mappings_;
  Reading reading_;  ///< state of read()
  Schema schema_;
  std::optional<Crs> crs_;
  std::optional<StatedCrs> stated_crs_;
  bool ignores_crs_ = false, replaces_crs_ = false;
  bool attributes_are_unused_ = false;  ///< see with_unused_attributes()
  std::shared_ptr<const LasOrigin> las_;
  std::vector<ValueRange> ranges_;
  std::vector<std::string> warnings_, missing_attributes_;
  std::uint64_t count_ = 0;  ///< number of rows before the selection
  std::shared_ptr<const RowSelection> selection_;
};

/// Opens the files that a path, a folder or a pattern means (files.h) as one cloud. With `ignore_crs`, the files may
/// have different coordinate reference systems.
std::unique_ptr<InputCloud> opened_cloud(const std::string& name, bool ignore_crs);

}  // namespace pointsweep
