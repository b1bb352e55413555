// SPDX-License-Identifier: MIT
/// Results of a run as arrays of NumPy.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/run.h"
#include "pointsweep/writer.h"

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

/// What a run is to return.
struct WantedArrays {
  std::vector<FieldGroup> groups;  ///< of the input
  std::set<std::string> names;     ///< of arrays or of single fields; empty: all
  bool made_only = false;          ///< nothing that the input has
};

/// Takes the records of a run apart.
class ResultArrays {
 public:
  explicit ResultArrays(WantedArrays wanted) : wanted_(std::move(wanted)) {}
  /// For Outputs::writer. *this outlives the run. Throws UsageError for a wanted name that there is not.
  std::unique_ptr<Writer> writer(const OutputPlan& plan);
  /// After the run, with the interpreter: name -> N or N×m array. Empties *this.
  nanobind::dict arrays();

 private:
  class Collector;
  struct Array {
    std::string name;
    Type type;
    std::vector<Field> fields;  ///< of the records
    ArrayMemory memory;
    std::size_t values = 1;  ///< of a row
    bool is_list = false;
  };
  void add(const std::string& name, const std::vector<std::string>& fields, const OutputPlan& plan);
  void require_all_wanted() const;

  WantedArrays wanted_;
  std::size_t rows_ = 0;
  std::vector<Array> arrays_;
  std::set<std::string> taken_;  ///< fields of the records that are in an array, where all are wanted
};

}  // namespace pointsweep
