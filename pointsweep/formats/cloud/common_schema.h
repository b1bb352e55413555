// SPDX-License-Identifier: MIT
/// One schema, one grid for integer coordinates, and one coordinate reference system for inputs that differ.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// Moves scaled 32-bit coordinates to another grid: raw = raw * factor + steps. Nothing is rounded.
struct GridShift {
  std::array<std::uint32_t, 3> offsets{};  ///< offsets of x, y and z in the record
  std::array<std::int64_t, 3> factors{1, 1, 1}, steps{};
  bool is_needed() const {
    return steps != std::array<std::int64_t, 3>{} || factors != std::array<std::int64_t, 3>{1, 1, 1};
  }
  /// Moves the coordinates of all records. Throws Error with `path` if a coordinate does not fit in 32 bits.
  void run(std::span<std::byte> records, std::size_t stride, const std::filesystem::path& path) const;
};

/// One grid for the integer coordinates of all inputs.
struct CommonGrid {
  LasQuantization grid;
  std::vector<GridShift> shifts;  ///< one for each input
};

/// Returns the grid of the finest scale on which every coordinate of every input lies, if there is one. Its conditions:
/// all x, y and z are scaled int32, each scale is a whole multiple of the finest, offsets differ by whole steps of the
/// finest scale, and the bounds in the headers stay within 32 bits. The offset of each axis is the first offset of an
/// input from which 32 bits reach all bounds. If no input has one, the offset lies near the middle of all bounds, a
/// multiple of kRoundSteps steps from the offset of the first input; if 32 bits do not reach all bounds from there,
/// there is no grid.
std::optional<CommonGrid> common_grid(const std::vector<std::shared_ptr<Reader>>& readers);

/// The values other than 0 of fields that an input lacks and other inputs have. Points without return numbers are
/// return 1 of 1, as LAS requires. Points of LAS point formats 0 to 5 in the overlap of flight lines have class 12;
/// together with inputs of formats 6 to 10 they also get the overlap flag of formats 6 to 10, and keep their class.
class MissingFields {
 public:
  MissingFields() = default;
  /// `common`: the schema to which the records of `input` are converted.
  MissingFields(const FileInfo& input, const Schema& common);

  bool is_needed() const { return !ones_.empty() || overlap_.has_value(); }
  /// Sets the values in records that have just been converted to the common schema.
  void run(std::span<std::byte> records, std::size_t stride) const;

 private:
  std::vector<Field> ones_;
  std::optional<std::pair<Field, Field>> overlap_;  ///< the fields classification and overlap
};

/// The fields of an input that hold integers of 64 bits and whose type in the common schema does not hold all of them.
class WideIntegers {
 public:
  WideIntegers() = default;
  /// `input`: the schema of an input, with the names that its fields have in `common`.
  WideIntegers(const Schema& input, const Schema& common);

  struct Loss {
    std::size_t record;
    std::string name, value;
    Type type;  ///< type of the field in the common schema
  };
  /// Returns the first value of `records`, records of the input `stride` bytes apart, that the type of its field in the
  /// common schema does not hold exactly. `wanted`: the fields of the common schema that have values; empty for all.
  std::optional<Loss> first_loss(std::span<const std::byte> records, std::size_t stride,
                                 const WantedFields& wanted) const;

 private:
  struct Narrowed {
    Field from;
    std::size_t index;  ///< index of the field in the common schema
    Type to;
  };
  std::vector<Narrowed> narrowed_;
};

/// The conversion of the records of one input to records of the cloud: `shift`, then `conversion`, then `missing`.
struct InputMapping {
  GridShift shift;
  std::shared_ptr<const RecordConversion> conversion;  ///< null if the input has the layout of the cloud
  MissingFields missing = {};
  WideIntegers wide = {};  ///< values that are checked before the conversion
};

struct CommonSchema {
  Schema schema;
  std::vector<InputMapping> mappings;  ///< one for each input
  std::vector<ValueRange> ranges;      ///< range of the values of each field that the types of the inputs allow
  /// One sentence for each input that lacks fields of another input, after five of them one sentence about all others,
  /// and one sentence about inputs whose 8-bit colours become 16-bit colours.
  std::vector<std::string> warnings;
};

/// Returns the common schema of the inputs, by the rules in the comment of class Cloud (cloud.h). Names with the same
/// meaning (`nx`, `NormalX`) are one field, under the name that comes first.
CommonSchema common_schema(const std::vector<std::shared_ptr<Reader>>& readers);

/// One coordinate reference system for several inputs.
struct CommonCrs {
  std::optional<Crs> crs;             ///< the user's system, else that of the first input that states one; its WKT may
                                      ///< come from another input
  std::vector<std::string> warnings;  ///< about inputs without a system, and systems that could not be compared or
                                      ///< differ
  bool replaces = false;              ///< true if an input states a system that is not known to be `crs`
};

/// Returns the system of the inputs. Throws UsageError for inputs with different systems. With `ignore` there is a
/// warning instead, and coordinates stay unchanged.
CommonCrs common_crs(const std::vector<std::shared_ptr<Reader>>& readers, bool ignore);

/// Returns the system that the user states. Throws UsageError if an input states another system, or one that cannot be
/// compared, unless StatedCrs::replaces is set or StatedCrs::crs is absent.
CommonCrs stated_crs(const std::vector<std::shared_ptr<Reader>>& readers, const StatedCrs& stated);

/// Returns ", e.g. by 'pdal translate ...'": a command that transforms a file to the system; empty without an EPSG
/// code.
std::string way_to_transform(const Crs& to);

}  // namespace pointsweep
