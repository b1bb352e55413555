// SPDX-License-Identifier: MIT
/// Assignment of values to attributes, for all points or those for which a condition holds.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators/expressions/assigned_target.h"
#include "pointsweep/operators/expressions/expression.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/row_error.h"

namespace pointsweep {

/// An assignment NAME = NUMBER [where CONDITION], e.g. intensity = intensity * 2 where classification == 2.
struct Assignment {
  std::string name;
  Expression value;
  std::optional<Expression> condition;

  std::string canonical() const;
};

/// Parses assignments separated by commas. Throws UsageError, beginning with `place`, for an invalid text.
std::vector<Assignment> assignments_of(std::string_view text, const std::string& place);

/// Makes a new version of one attribute, or a new attribute. Values of whole-number types are rounded to the nearest,
/// halves to even.
class SetAttribute final : public LocalOperator {
 public:
  /// `type`: type of a new attribute, or of an attribute of the input that is assigned without a condition. If absent,
  /// a new attribute gets the type of the LAS field with its name, else float64.
  SetAttribute(Assignment assignment, std::optional<Type> type, std::string place = "set");
  std::string name() const override { return "set"; }
  Contract contract() const override;
  /// Throws RowError naming the lowest row with a value that the type of the attribute cannot hold.
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::array<bool, 3> changes_system() const override { return {component_ == 0, component_ == 1, component_ == 2}; }
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  void find_target(const Schema& input, std::span<const Attribute> made);
  /// Returns the index, in contract().reads, of the first attribute that the condition reads. The attributes that the
  /// value reads come before it.
  std::size_t first_of_condition() const { return value_names_.reads().size(); }
  RowSentence refusal(const std::string& value) const;
  template <class T>
  void assign(const Neighborhoods& in, Columns& out) const;
  /// Returns the value in the type of the attribute; nullopt if the type cannot hold the value.
  template <class T>
  std::optional<T> stored(double value, bool is_placed) const;

  Assignment assignment_;
  std::optional<Type> type_;
  std::string place_;
  NamedValues value_names_, condition_names_;
  Attribute target_;
  std::size_t component_ = 0;
  TargetRange range_;
  bool is_retyped_ = false;  ///< true if the attribute of the input has another type than target_
  std::optional<Attribute> old_;
  std::optional<std::size_t> old_value_;
};

/// Several assignments in order: each uses the results of the previous ones.
class Set final : public CompositeOperator {
 public:
  Set(std::string_view assignments, std::optional<Type> type, const std::string& place = "set");
  std::string name() const override { return "set"; }
  Contract contract() const override;
  std::vector<ChainStage> parts() const override { return parts_; }

 private:
  std::vector<ChainStage> parts_;
  std::vector<Assignment> assignments_;
};

}  // namespace pointsweep
