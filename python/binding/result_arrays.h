// SPDX-License-Identifier: MIT
/// Results of a run as arrays of NumPy.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/run.h"
#include "pointsweep/storage/local/spill_file.h"
#include "pointsweep/writer.h"
#include "python/binding/array_columns.h"

namespace pointsweep {

/// Memory that is not set to 0 before it is written.
struct ArrayMemory {
  std::unique_ptr<std::byte[]> bytes;
  explicit ArrayMemory(std::size_t size) : bytes(new std::byte[size]) {}
};

/// Returns a NumPy array that owns `memory`.
nanobind::object numpy_array(ArrayMemory memory, const std::vector<std::size_t>& shape, Type type);

/// Returns the type of the array for the values of `field`: f64 if the field has a scale or an offset; u8, u16 or u32
/// for a bit field; else the type of the field.
Type result_type(const Field& field);

/// The name of an array and the fields that are its components, e.g. {"xyz", {"x", "y", "z"}}.
using FieldGroup = std::pair<std::string, std::vector<std::string>>;

/// The arrays that a run is to return.
struct WantedArrays {
  std::vector<FieldGroup> groups;                  ///< groups of fields of the input
  std::set<std::string> names;                     ///< names of arrays or of single fields; empty: all
  bool made_only = false;                          ///< true to exclude attributes of the input
  std::map<std::string, WritableArray> into = {};  ///< existing arrays to fill, by name
};

/// Splits the records of a run into arrays: new ones in memory or in a temporary file, and existing ones.
class ResultArrays {
 public:
  explicit ResultArrays(WantedArrays wanted) : wanted_(std::move(wanted)) {}
  /// Stores the arrays in an unnamed file in `folder` (empty: the temporary folder of the system). Throws Error if the
  /// file cannot be created.
  ResultArrays(WantedArrays wanted, const std::filesystem::path& folder);
  /// Returns a writer for Outputs::writer. *this must outlive the run. Throws UsageError for a wanted name that does
  /// not exist, and for an existing array whose type or shape differs from that of the result.
  std::unique_ptr<Writer> writer(const OutputPlan& plan);
  /// Returns name -> (N or N×m array, or for an existing array the number of its first rows that were filled; names of
  /// its components) after the run. The calling thread must be attached to the interpreter. Empties *this.
  nanobind::dict arrays();
  /// Returns the arrays of the rows [first, first + rows), or of fewer rows at the end. Only for arrays in a file.
  nanobind::dict read(std::size_t first, std::size_t rows) const;
  std::size_t rows() const { return rows_; }

 private:
  class Collector;
  struct Array {
    std::string name;
    Type type;
    std::vector<Field> fields;  ///< fields of the records
    ArrayMemory memory;
    std::byte* first;        ///< address of the values, in memory or in an existing array; null: in the file
    std::size_t values = 1;  ///< number of values of a row
    bool is_list = false;
    std::uint64_t offset = 0;  ///< offset in the file

    std::size_t row_bytes() const { return values * size_of(type); }
    std::vector<std::string> components() const;
    /// Returns (array of `rows` rows with the bytes `values`, names of the components).
    nanobind::tuple with_names(ArrayMemory values, std::size_t rows) const;
  };
  void add(const std::string& name, const std::vector<std::string>& fields, const OutputPlan& plan);
  /// Returns the address of the existing array with that name; null if there is none. Throws UsageError if its type or
  /// shape differs.
  std::byte* place_in(const std::string& name, Type type, std::size_t values) const;
  /// Adds arrays for wanted names that spell a field in another way than the records, such as "intensity" for
  /// "Intensity".
  void add_in_other_spellings(const OutputPlan& plan);
  void require_all_wanted() const;

  WantedArrays wanted_;
  std::size_t rows_ = 0;
  std::optional<SpillFile> file_;
  std::vector<Array> arrays_;
  std::set<std::string> taken_;  ///< fields that an array already has; empty unless all fields are wanted
};

}  // namespace pointsweep
