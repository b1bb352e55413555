// SPDX-License-Identifier: MIT
/// The assembly of output records from records of the input and the values that the operators made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/pipeline/plan/kept_fields.h"
#include "pointsweep/points/record_map.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns whether one of the made attributes is the position.
bool moves_points(const std::vector<Attribute>& made);

/// The row numbers of successive records, for messages: each[i] if `each` is not null, else first + i.
struct RowNumbers {
  std::uint64_t first = 0;
  const std::uint64_t* each = nullptr;
  std::uint64_t of(std::size_t i) const { return each != nullptr ? each[i] : first + i; }
};

/// The layout of output records: the record of the input without the number of its row, or its kept fields without
/// gaps; then the other made fields. A made field replaces the field of the input of the same name at its place, with
/// the made type, so that no value is rounded to the input's type; but bit fields keep their storage, to which made
/// values are converted.
class OutputLayout {
 public:
  /// `positions`: type of x, y and z, moved or not; absent: the type of the input, or float64 for moved points.
  OutputLayout(const Schema& input, const std::vector<Attribute>& made, const KeptFields& kept = {},
               std::optional<Type> positions = std::nullopt);

  const Schema& schema() const { return schema_; }
  /// Returns whether output records equal records of the input, so that they need no assembly.
  bool passes_inputs() const;
  /// Makes `n` output records of schema() from `n` records of the input and `n` result records. Throws RowError for the
  /// lowest row with a value that its field cannot hold, or that an integer field without scale would round.
  void assemble(const std::byte* inputs, const std::byte* results, std::size_t n, std::byte* outputs,
                RowNumbers rows = {}) const;
  /// Assembles successive records on all threads. `results` is null if nothing is made. `first`: the first row.
  void assemble_all(const std::byte* inputs, const std::byte* results, std::size_t n, std::byte* outputs,
                    std::uint64_t first) const;

 private:
  using Types = std::map<std::size_t, Type>;  ///< new types of fields of the input, by index
  static Types replaced(const Schema& input, const std::vector<Attribute>& made, const KeptFields& kept,
                        std::optional<Type> positions);
  void convert_positions(const Schema& input, const Types& types, const std::vector<Attribute>& made);
  void retype(const Types& types);
  void keep_fields(const Schema& input, const std::vector<std::size_t>& kept, const Types& types);
  void add(const Field& from, const Field& to);
  void require_held(const std::byte* inputs, const std::byte* results, std::size_t n, RowNumbers rows) const;
  void assemble_block(const std::byte* inputs, const std::byte* results, std::size_t n, std::byte* outputs) const;

  Schema schema_;
  std::uint32_t input_stride_;
  std::uint32_t result_stride_ = 0;
  RecordMap passed_;                                  ///< copies from records of the input
  RecordMap copies_;                                  ///< copies from result records
  std::vector<std::pair<Field, Field>> conversions_;  ///< conversions from result records
  std::vector<std::pair<Field, Field>> retyped_;      ///< conversions of input positions that no stage has moved
};

}  // namespace pointsweep
