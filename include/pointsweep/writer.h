// SPDX-License-Identifier: MIT
/// Writing points: files, complete or not at all, arrays in memory, and formats of your own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/crs.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/reader.h"

namespace pointsweep {

struct KnownValues;
class Scratch;

/// A position that the user states, or that a writer chooses near the middle of the points.
struct Anchor {
  std::optional<Vec3> at = {};  ///< stated position; absent if the writer chooses one
  friend bool operator==(const Anchor&, const Anchor&) = default;
};

/// Options of a user for the way in which a file stores points. The writer chooses absent options. Only some formats
/// support each option; for other formats a run throws UsageError.
struct FileLayout {
  /// For LAS: length of a step of the integer coordinates on each axis, above 0. Coordinates are rounded to the nearest
  /// step. If absent, the writer takes the scale of the inputs, or the finest scale with which integers reach all
  /// points.
  std::optional<Vec3> scale = {};
  /// For LAS: the coordinates for which the integers 0 stand. If Anchor::at is absent, the writer takes the multiple of
  /// 1,000 steps nearest to the middle of the points. If `offset` is absent, the writer takes the offset of the inputs,
  /// moved by whole steps if integers do not reach all points; without one, a round number near the middle.
  std::optional<Anchor> offset = {};
  /// For LAS: point format, 0 to 10. Attributes for which the format has no field become extra bytes.
  std::optional<int> point_format = {};
  std::optional<int> las_version = {};  ///< for LAS: minor version, 0 to 4 for LAS 1.0 to 1.4
  std::optional<int> decimals = {};     ///< for text: number of digits of x, y and z after the decimal point, 0 to 15
  friend bool operator==(const FileLayout&, const FileLayout&) = default;
};

/// The plan of an output. Records come in `schema`: first the fields of the input in the input's layout, then the
/// fields that operators made ("nx", "ny", "nz", ...). The writer maps them to names and types of its format.
struct OutputPlan {
  std::filesystem::path path;
  Schema schema;                               ///< layout of the records, with fields in the order of columns
  std::uint64_t count = 0;                     ///< exact number of records to be written
  std::shared_ptr<const FormatExtras> extras;  ///< extras of the first input; null if it has none
  bool overwrite = false;                      ///< if false, an existing file is an error
  /// Box of the finite coordinates. Formats that store integers (LAS) need it if the input has another format, since
  /// their scale must be known before the first record.
  std::optional<Box> bounds = std::nullopt;
  /// Coordinate reference system of the points. May be absent if `extras` hold it and the output has their format.
  std::optional<Crs> crs = std::nullopt;
  /// True if `crs`, or no system if `crs` is absent, replaces the system in `extras`.
  bool replaces_crs = false;
  /// The meaning of coordinates and times in an input that is or was LAS.
  std::shared_ptr<const LasOrigin> las = nullptr;
  /// Known ranges of the values of the input's fields, which come first in `schema`; null if only types are known.
  std::shared_ptr<const KnownValues> values = nullptr;
  /// The extras of the inputs after the first. One of several extras that are alike (FormatExtras::is_like) may stand
  /// for all of them.
  std::vector<std::shared_ptr<const FormatExtras>> other_extras = {};
  /// The attributes in `schema` that operators made. Formats that describe attributes use their meaning.
  std::vector<Attribute> made = {};
  /// Lines about the making of the file, which it stores after the lines of `extras`. Formats that cannot store such
  /// lines ignore them.
  std::vector<std::string> provenance = {};
  FileLayout layout = {};
  /// Memory in bytes for encoding several pieces at once; 0 for enough memory for a few pieces.
  std::uint64_t encoder_bytes = 0;
  /// Function that makes temporary files for a writer that stores all points until it knows their order; empty to keep
  /// them in memory.
  std::function<std::unique_ptr<Scratch>()> scratch = {};
  /// Folder in which an output to a URL is stored until it is complete; empty for the system's folder for temporary
  /// files.
  std::filesystem::path temp_folder = {};
  /// Function that a writer whose finish() takes long, because it puts points in another order, calls with the number
  /// of points that have reached their place in the output. May be empty, and may throw.
  std::function<void(std::uint64_t points)> progress = {};
};

/// Takes the records of an output. The library's writers write a hidden file beside its destination, which finish()
/// renames. Destruction without finish() removes this file, so that no half-written output is ever visible. A writer of
/// your own should do likewise.
class POINTSWEEP_EXPORT Writer {
 public:
  virtual ~Writer() = default;

  /// Appends whole records. One call with many records is faster than many calls with few. Throws Error if the records
  /// cannot be written, e.g. because no space is left.
  virtual void write(std::span<const std::byte> records) = 0;

  /// Returns whether write_at() works, as in formats whose records have a fixed size in the file.
  virtual bool can_write_at() const { return false; }
  /// Writes whole records at `row`; every row must be written at least once, in any order. A caller uses either write()
  /// or write_at(). Not thread-safe.
  virtual void write_at(std::uint64_t row, std::span<const std::byte> records);

  /// Completes the file and renames it to its destination. Must be the last call. Throws Error if the number of records
  /// was wrong.
  virtual void finish() = 0;

  std::uint64_t bytes_written() const { return bytes_written_; }
  /// Returns sentences about values that the format cannot hold. The list is complete when finish() has returned.
  const std::vector<std::string>& warnings() const { return warnings_; }
  void add_warning(std::string warning) { warnings_.push_back(std::move(warning)); }

 protected:
  std::uint64_t bytes_written_ = 0;
  std::vector<std::string> warnings_;
};

/// Makes a writer for the format that the extension of the path means. Throws Error, before anything is written, for an
/// unknown extension, an output that exists, and a folder that is missing or read-only.
POINTSWEEP_EXPORT std::unique_ptr<Writer> create_writer(const OutputPlan& plan);

/// Collects the fields `names` of the plan into `values`: N×names.size() values, the values of a point side by side. T
/// is float, double, std::uint32_t or std::uint64_t. The path of the plan is not used.
template <class T>
class POINTSWEEP_EXPORT ArrayWriter final : public Writer {
 public:
  /// Throws UsageError if a field is missing or `values` has another size. Borrows `values` until finish().
  ArrayWriter(const OutputPlan& plan, const std::vector<std::string>& names, std::span<T> values);

  void write(std::span<const std::byte> records) override;
  bool can_write_at() const override { return true; }
  void write_at(std::uint64_t row, std::span<const std::byte> records) override;
  void finish() override;

 private:
  std::vector<Field> fields_;  ///< for each column of values, a field with one component
  std::size_t stride_;
  std::span<T> values_;
  std::uint64_t count_;
  std::uint64_t rows_written_ = 0;
};

extern template class ArrayWriter<float>;
extern template class ArrayWriter<double>;
extern template class ArrayWriter<std::uint32_t>;
extern template class ArrayWriter<std::uint64_t>;

}  // namespace pointsweep
