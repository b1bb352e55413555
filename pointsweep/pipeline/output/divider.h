// SPDX-License-Identifier: MIT
/// The division of an output among many files: square tiles, or a file for each value of an attribute. The file of a
/// tile may also contain a buffer: the points of adjacent tiles near its edges (OutputDivision::tile_buffer).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "pointsweep/formats/format.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/run.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Largest number of files of a divided output, in a run that may not overwrite files.
inline constexpr std::size_t kMostFiles = 10'000;

/// The identity of a file: the numbers of its tile in x and in y; or the value of the attribute (a uint64 by its bits)
/// and 0; or, for the file `unplaced`, the least int64 and 0.
struct FileKey {
  std::int64_t first = 0, second = 0;
  friend auto operator<=>(const FileKey&, const FileKey&) = default;
};
struct FileKeyHash {
  std::size_t operator()(const FileKey& key) const;
};

/// A file of a divided output, with its numbers of points.
struct DividedFile {
  FileKey key;
  std::uint64_t own = 0, all = 0;  ///< its number of points, without and with the points of its buffer
};

/// Returns the number of files with points outside of their buffer.
std::size_t files_with_points(std::span<const DividedFile> files);

/// Square tiles in x and y. Tile i of an axis holds [edge(i), edge(i + 1)), its lower edge included. edge(i) = origin +
/// i * size in float64, with one rounding for the product and one for the sum. So each coordinate that tile_of()
/// accepts is in exactly one tile, which users can check by comparing float64 values.
class TileGrid {
 public:
  TileGrid(double size, const std::array<double, 2>& origin);

  double edge(std::size_t axis, std::int64_t tile) const { return origin_[axis] + static_cast<double>(tile) * size_; }
  /// Returns the tile of a finite coordinate. Throws UsageError if the size of a tile is at most 2^-48 of the
  /// coordinate or of the origin, so that edges might be equal in float64.
  std::int64_t tile_of(std::size_t axis, double coordinate) const;
  /// Returns the lower edge as a decimal number with as many digits after the point as the size or the origin has,
  /// whichever has more: "500", "-62.5".
  std::string edge_text(std::size_t axis, std::int64_t tile) const;

 private:
  double size_;
  std::array<double, 2> origin_;
  std::array<int, 2> digits_;  ///< digits after the decimal point, for x and y
};

/// Assigns points to files. The tile of a point follows from the coordinates that a reader of the output gets, after
/// any rounding by the format. With tiles, points whose x or y is not finite have a file of their own, `unplaced`.
class Divider {
 public:
  /// `plan.path` is the path of the files, with a * for the name of each. Throws UsageError for an attribute that is
  /// missing or not one whole number for each point, and for buffers if the points already have an attribute `buffer`.
  Divider(OutputPlan plan, const OutputDivision& division);
  /// Throws the errors of create_writer(), except for an existing file.
  void require_writable() const;

  /// Returns the plan of all files together. With buffers, its records have one attribute more than the records that
  /// are divided.
  const OutputPlan& plan() const { return plan_; }
  bool has_buffers() const { return division_.tile_buffer > 0; }
  /// Returns the bytes of a record before the division, without the attribute `buffer`.
  std::size_t record_bytes() const { return record_bytes_; }

  /// Returns the file that owns the point.
  FileKey key_of(const std::byte* record) const;
  /// Calls `use` for each other tile that has the point in its buffer. `own` is key_of(record).
  void for_each_buffer(const std::byte* record, const FileKey& own, const std::function<void(FileKey)>& use) const;
  /// Fills a record of a file: copies `record`, and with buffers appends 0 for a point of the file's own tile, 1 for a
  /// point of the buffer.
  void copy(const std::byte* record, bool is_own, std::byte* to) const;

  std::filesystem::path path_of(const FileKey& key) const;
  /// Returns the plan of one file.
  OutputPlan plan_of(const DividedFile& file) const;
  /// Returns whether the file has the points that are in no tile.
  bool is_unplaced(const FileKey& key) const;
  /// Throws UsageError if `files` is more than kMostFiles and the run may not overwrite files.
  void require_few(std::size_t files) const;

 private:
  void choose_attribute(const std::string& word);
  std::string name_of(const FileKey& key) const;
  double coordinate_of(std::size_t axis, const std::byte* record) const;

  OutputPlan plan_;
  OutputDivision division_;
  std::size_t record_bytes_;
  std::optional<TileGrid> grid_;  ///< absent: an attribute divides the points
  std::array<Field, 2> xy_;       ///< x and y in the records, for tiles
  StoredCoordinate stored_;       ///< rounds a coordinate as the output's format does; null: exact
  Field attribute_;               ///< field whose values divide the records
  std::string attribute_name_;    ///< name of the attribute in file names
};

}  // namespace pointsweep
