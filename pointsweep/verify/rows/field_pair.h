// SPDX-License-Identifier: MIT
/// A value that should have come into a file, and the place where it should be; a made value, and the estimate of its
/// formula.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/math/mix.h"
#include "pointsweep/points/decimals.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep {

/// Compares a value of one record with its copy in another, as far as the type of the copy can tell. Values are equal
/// if
/// - both are stored alike and their bits are equal; or else
/// - storing `from` at `to`, colours with the brightness of the type there, gives what is there: a format may round
///   (LAS coordinates), and a value out of the range of its type equals nothing; integers on a decimal grid may be the
///   decimal fractions that they mean; where `from` is float32 and `to` float64, the nearest float32 of `to` counts,
///   since text files hold the fewest digits of a float.
class FieldPair {
 public:
  /// Pairs one component of each field; `name` is used in messages.
  /// `digits`: the values are written as text with as many digits after the decimal point.
  FieldPair(std::string name, const Field& from, std::uint32_t from_component, const Field& to,
            std::uint32_t to_component, std::optional<int> digits = {});

  const std::string& name() const { return name_; }
  /// A word that is the same for equal values: from a record with `from`, and from one with `to`.
  std::uint64_t expected(const std::byte* from_record) const;
  std::uint64_t found(const std::byte* to_record) const;
  /// Returns by how much a format may change `value` in storing it: half a unit of what `to` can hold.
  double resolution(double value) const;
  double expected_value(const std::byte* from_record) const { return value_of(from_, from_record); }
  double found_value(const std::byte* to_record) const { return value_of(to_, to_record); }

 private:
  std::uint64_t word_of(double value) const;

  std::string name_;
  Field from_, to_;
  bool bitwise_;
  GridDecimals decimals_;  ///< of integers on a decimal grid, which text files hold as the decimal fractions they mean
  bool single_;
  std::optional<int> digits_;
};

/// Pairs of all components of from.fields[index] with where a writer of any format may have put them in `to`; nothing
/// if a component is nowhere. Writers change characters and lengths of names, number components, use the spelling of
/// their format, and add an exact copy NAME_TYPE of what their format rounds: then the copy counts.
/// `decimals`: x, y and z are written as text with as many digits after the decimal point.
std::optional<std::vector<FieldPair>> pairs_of_field(const Schema& from, std::size_t index, const Schema& to,
                                                     std::optional<int> decimals = {});

/// The sum of mixed values modulo 2^64, in any order: equal for equal multisets, and for different ones with
/// probability 2^-64.
class MultisetSum {
 public:
  void add(std::uint64_t value) { sum_ += mix(value); }
  std::uint64_t sum() const { return sum_; }

 private:
  std::uint64_t sum_ = 0;
};

/// The components of an attribute, one to three, that share one estimate, and their places in the output.
class MadeValue {
 public:
  /// `pairs`: from a result record to a record of the output, one for each component; none for one not written.
  explicit MadeValue(std::vector<std::optional<FieldPair>> pairs) : pairs_(std::move(pairs)) {}

  /// The first wrong component; nothing if the value is right. Estimates without error are compared as FieldPair does,
  /// bit for bit where types are alike; others must not differ by more than their error and one rounding to the type
  /// of the output.
  std::optional<std::size_t> wrong_component(const formulas::Estimate& estimate, const std::byte* result,
                                             const std::byte* record) const;
  /// "nx is 0.3, but 0.2 by brute force, give or take 1e-07".
  std::string difference(std::size_t component, const formulas::Estimate& estimate, const std::byte* result,
                         const std::byte* record) const;

  /// Returns how far the value in the output is from the nearest right one, beyond what its type rounds; 0 is exact.
  formulas::Real distance(const formulas::Estimate& estimate, const std::byte* record) const;

 private:
  formulas::Real distance_to(formulas::Vector expected, const std::byte* record) const;

  std::vector<std::optional<FieldPair>> pairs_;
};

}  // namespace pointsweep
