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

/// An array of NumPy that owns `memory`.
nanobind::object numpy_array(ArrayMemory memory, const std::vector<std::size_t>& shape, Type type);

/// The type of the array that holds the values of `field`: with a scale they are f64; those of some bits fit u8 to u32.
Type result_type(const Field& field);

/// Components that make one array, e.g. {"xyz", {"x", "y", "z"}}.
using FieldGroup = std::pair<std::string, std::vector<std::string>>;

/// The arrays that a run is to return.
struct WantedArrays {
  std::vector<FieldGroup> groups;                  ///< of the input
  std::set<std::string> names;                     ///< of arrays or of single fields; empty: all
  bool made_only = false;                          ///< nothing that the input has
  std::map<std::string, WritableArray> into = {};  ///< by name, arrays that are there
};

/// Takes the records of a run apart, into arrays in memory or in a temporary file.
class ResultArrays {
 public:
  explicit ResultArrays(WantedArrays wanted) : wanted_(std::move(wanted)) {}
  /// The arrays are in a nameless file in `folder` (empty: the system's). Throws Error if none can be made there.
  ResultArrays(WantedArrays wanted, const std::filesystem::path& folder);
  /// For Outputs::writer. *this outlives the run. Throws UsageError for a wanted name that there is not.
  std::unique_ptr<Writer> writer(const OutputPlan& plan);
  /// After the run, with the interpreter: name -> (N or N×m array, or None where it was there; names of its
  /// components). Empties *this.
  nanobind::dict arrays();
  /// Returns the arrays of the rows [first, first + rows), fewer rows at the end, where the arrays are in a file.
  nanobind::dict read(std::size_t first, std::size_t rows) const;
  std::size_t rows() const { return rows_; }

 private:
  class Collector;
  struct Array {
    std::string name;
    Type type;
    std::vector<Field> fields;  ///< of the records
    ArrayMemory memory;
    std::byte* first;        ///< of the values, in memory or in an array that was there; null: in the file
    std::size_t values = 1;  ///< of a row
    bool is_list = false;
    std::uint64_t offset = 0;  ///< in the file

    std::size_t row_bytes() const { return values * size_of(type); }
    std::vector<std::string> components() const;
    /// (`rows` rows in `values`, names of the components).
    nanobind::tuple with_names(ArrayMemory values, std::size_t rows) const;
  };
  void add(const std::string& name, const std::vector<std::string>& fields, const OutputPlan& plan);
  /// Returns the place for the values of a new array in an array that was given; null: none was given.
  std::byte* place_in(const std::string& name, Type type, std::size_t values) const;
  void require_all_wanted() const;

  WantedArrays wanted_;
  std::size_t rows_ = 0;
  std::optional<SpillFile> file_;
  std::vector<Array> arrays_;
  std::set<std::string> taken_;  ///< fields of the records that are in an array, where all are wanted
};

}  // namespace pointsweep
