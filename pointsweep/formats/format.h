// SPDX-License-Identifier: MIT
/// The description of a format and of the possible contents of its files. Each format defines one Format, beside its
/// code; registry.cpp lists all formats. Other layers use a Format and never compare names or extensions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

class InputCloud;

/// Returns the coordinate on an axis (0, 1, 2) that is read back from an output after `value` was written.
using StoredCoordinate = std::function<double(std::size_t axis, double value)>;

/// Returns whether this library was built with the codecs (codecs/).
bool has_codecs();

struct Format {
  enum class Content : std::uint8_t {
    points,  ///< points with attributes
    array    ///< the values of one attribute, without coordinates
  };

  std::string_view name;     ///< name for sentences: "LAS"
  std::string_view title;    ///< name for tables: "LAS 1.0 to 1.4"
  std::string_view details;  ///< page or section of docs/formats.md with more details; "" if there is none
  std::string_view reads;    ///< for tables: which files of the format can be read; "no" if none
  std::string_view writes;   ///< for tables: which files can be written; "no" if none
  /// File extensions of the format, in lower case. An output with one of these extensions is written in this format, if
  /// `create` is set.
  std::span<const std::string_view> extensions;
  /// The codec that files of the format need; "" if none. A build without the codec recognises the files and refuses
  /// them with an error.
  std::string_view codec = "";

  /// The word for this format in --format (CloudOptions::format). A format with such a word has no signature, and its
  /// files are read only if the user names it. "" for all other formats.
  std::string_view asked_for_as = "";

  /// Returns whether a file that begins with `head` (at most 4,096 bytes) is of this format. Null for a format without
  /// signature: it is tried after all other formats and the foreign formats, or only if the user names it
  /// (asked_for_as).
  bool (*is)(std::string_view head) = nullptr;
  /// For a format without signature: returns whether the first lines of a file belong to the format. A folder may
  /// contain other texts. `columns`: as for open_columns; empty if none are stated.
  bool (*fits)(const std::filesystem::path& path, std::span<const std::string> columns) = nullptr;
  std::unique_ptr<Reader> (*open)(const std::filesystem::path& path) = nullptr;  ///< null if the format is not read
  /// Opens a file whose columns have these names, "-" for a column that is skipped. The header of the file is ignored.
  /// Null for formats whose files describe themselves.
  std::unique_ptr<Reader> (*open_columns)(const std::filesystem::path& path,
                                          std::span<const std::string> columns) = nullptr;
  std::unique_ptr<Writer> (*create)(const OutputPlan& plan) = nullptr;  ///< null if the format is not written

  Content content = Content::points;
  bool holds_crs = false;         ///< files of the format can hold a coordinate reference system
  bool holds_provenance = false;  ///< files of the format can hold the record of their run
  bool is_sequential = false;     ///< the writer can write to standard output, since it writes all bytes in order
  bool reorders = false;          ///< the writer changes the order of points
  /// True if coordinates may be any float64, NaN and infinity included; false if they are integers on a grid of finite
  /// steps.
  bool real_coordinates = true;
  /// True if a point with a coordinate that is not finite is read back with NaN for all coordinates.
  bool loses_nonfinite = false;
  /// True if the header states the box of all points (FileInfo::bounds), so that a run need not read the points to find
  /// the box.
  bool states_bounds = false;
  /// Returns the least memory in bytes with which the writer encodes records of `record_bytes` on `threads` threads;
  /// null: negligible.
  std::uint64_t (*encoder_bytes)(std::uint64_t record_bytes, unsigned threads) = nullptr;
  /// Returns the number of bytes that the writer stores in OutputPlan::scratch, for `count` records of `record_bytes`,
  /// with `memory` as OutputPlan::encoder_bytes on `threads` threads; null: none.
  std::uint64_t (*aside_bytes)(std::uint64_t count, std::uint64_t record_bytes, std::uint64_t memory,
                               unsigned threads) = nullptr;
  std::size_t name_bytes = 0;  ///< most bytes in the name of an attribute; 0: any number
  /// Returns the name of an attribute in outputs of the format; null: unchanged.
  std::string (*stored_name)(const std::string& name) = nullptr;
  /// Returns the value of a field in outputs of the format if neither an input nor a stage gives a value; none for
  /// names that are not the format's own. Null: the format has no such fields.
  std::optional<double> (*own_field)(std::string_view name) = nullptr;
  /// The options of FileLayout that the writer supports, by their names among the options of runs.
  std::span<const std::string_view> layout = {};
  /// Returns whether OutputPlan::bounds must be known before records of `schema` are written; null: never.
  bool (*needs_bounds)(const Schema& schema, const FileLayout& layout) = nullptr;
  /// Returns OutputPlan::values for a cloud, and may read the points of the cloud once. Null: the format needs no
  /// values. `progress` gets the number of points read; it may throw.
  KnownValues (*values)(InputCloud& cloud, const FileLayout& layout,
                        const std::function<void(std::uint64_t rows)>& progress) = nullptr;
  /// Returns whether values() reads the points of the cloud; null if `values` is null.
  bool (*values_need_points)(const InputCloud& cloud, const FileLayout& layout) = nullptr;
  /// Returns how the output of a plan rounds coordinates; none if the output stores coordinates unchanged. Null: no
  /// output rounds coordinates.
  StoredCoordinate (*stored_coordinate)(const OutputPlan& plan) = nullptr;

  /// Returns whether this build has the codec that the format needs, or the format needs none.
  bool is_built_in() const { return codec.empty() || has_codecs(); }
};

// The formats, each defined in its folder.
extern const Format kPlyFormat, kLasFormat, kCopcFormat, kLazFormat, kPcdFormat, kE57Format, kPtxFormat, kVtkFormat,
    kOffFormat, kObjFormat, kQsplatFormat, kTextFormat, kPtsFormat;
/// Text with commas and a line of names. The writer adds no comments, since most programs cannot read .csv with
/// comments.
extern const Format kCsvFormat;
extern const Format kNpyPointsFormat;               ///< points, as input only
extern const Format kNpyFormat;                     ///< neighbours and distances
extern const Format kKittiFormat, kFloatXyzFormat;  ///< files without a signature

/// Returns the extras as an `Extras`; null for extras of a format other than Extras::kFormat, and for no extras.
template <class Extras>
const Extras* extras_as(const std::shared_ptr<const FormatExtras>& extras) {
  return extras && extras->format() == Extras::kFormat ? static_cast<const Extras*>(extras.get()) : nullptr;
}

}  // namespace pointsweep
