// SPDX-License-Identifier: MIT
#include "pointsweep/operators/rows/set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "pointsweep/chain.h"
#include "pointsweep/fail.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/points/with_type.h"
#include "pointsweep/row_error.h"

namespace pointsweep {
namespace {

constexpr Type kAllTypes[] = {Type::i8,  Type::u8,  Type::i16, Type::u16, Type::i32,
                              Type::u32, Type::i64, Type::u64, Type::f32, Type::f64};

/// The types of the fields of LAS, which new attributes with the names of these fields get unless `as` states a type.
using LasType = std::pair<std::string_view, Type>;
constexpr LasType kTypesOfLas[] = {{"classification", Type::u8},
                                   {"intensity", Type::u16},
                                   {"return_number", Type::u8},
                                   {"number_of_returns", Type::u8},
                                   {"scan_direction_flag", Type::u8},
                                   {"edge_of_flight_line", Type::u8},
                                   {"synthetic", Type::u8},
                                   {"key_point", Type::u8},
                                   {"withheld", Type::u8},
                                   {"overlap", Type::u8},
                                   {"scanner_channel", Type::u8},
                                   {"user_data", Type::u8},
                                   {"point_source_id", Type::u16},
                                   {"red", Type::u16},
                                   {"green", Type::u16},
                                   {"blue", Type::u16},
                                   {"nir", Type::u16}};

constexpr std::uint64_t kMostExact = std::uint64_t{1} << 53;  ///< float64 holds all whole numbers up to this one

/// Returns whether a 64-bit integer takes part in the result of point `i` that float64 may have rounded: an integer
/// beyond 2^53, or any if `result` is beyond 2^53.
bool may_be_rounded(std::span<const ExpressionValues> values, std::size_t i, double result) {
  return std::ranges::any_of(values, [&](const ExpressionValues& v) {
    if (v.whole == nullptr) return false;
    const std::uint64_t number = v.whole[i];
    return std::abs(result) > static_cast<double>(kMostExact) ||
           (v.is_signed && number >> 63 != 0 ? 0 - number : number) > kMostExact;
  });
}

std::vector<std::string> names_of_types() {
  std::vector<std::string> names;
  for (const Type type : kAllTypes) names.emplace_back(name_of(type));
  return names;
}

/// Returns the index of the word `where` in the text, a result of with_hidden_names(); npos if the text does not
/// contain it.
std::size_t place_of_where(std::string_view text) {
  for (std::size_t at = text.find("where"); at != text.npos; at = text.find("where", at + 1)) {
    const bool begins = at > 0 && !continues_name(text[at - 1]);
    if (begins && (at + 5 == text.size() || !continues_name(text[at + 5]))) return at;
  }
  return text.npos;
}

/// Returns the index of the comma that ends the assignment that begins at `begin`, or the size of the text, a result of
/// with_hidden_names().
std::size_t end_of_assignment(std::string_view text, std::size_t begin) {
  int open = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    open += text[i] == '(' ? 1 : text[i] == ')' ? -1 : 0;
    if (text[i] == ',' && open <= 0) return i;
  }
  return text.size();
}

Assignment assignment_of(std::string_view text, const std::string& place) {
  const std::string hidden = with_hidden_names(text);
  const std::size_t equals = hidden.find('=');
  const std::string_view name = name_in(text.substr(0, equals));
  if (equals == text.npos || name.empty() || text.substr(equals + 1).starts_with('='))
    fail_usage("{}: '{}' assigns nothing; write NAME = EXPRESSION, as in classification = 7 where outlier == 1.", place,
               without_outer_blanks(text));
  const std::string_view rest = text.substr(equals + 1);
  const std::size_t where = place_of_where(std::string_view(hidden).substr(equals + 1));
  Assignment assignment{std::string(name), Expression(rest.substr(0, where), place, Expression::Form::number), {}};
  if (where != rest.npos) assignment.condition.emplace(rest.substr(where + 5), place);
  return assignment;
}

struct SetOptions {
  std::string assign = {};
  std::optional<Type> as = {};
};

const OptionTable<SetOptions>& set_options() {
  static const OptionTable<SetOptions> table = {
      option("assign", &SetOptions::assign,
             "NAME = EXPRESSION or NAME = EXPRESSION where CONDITION, several with commas between, done one after "
             "another; "
             "expressions and conditions are those of where; 'assign=' may be left out",
             {.kind = OptionKind::assignments,
              .required = true,
              .positional = true,
              .sample = "classification = 7 where z > 100"}),
      option("as", &SetOptions::as,
             "type of new attributes, and of those of the input that are assigned without a condition; without this "
             "option new ones are float64, or of the type that LAS has for the name, such as uint8 for "
             "classification",
             {.choices = names_of_types(), .sample = "float32"})};
  return table;
}

/// Makes a new version of one attribute, or a new attribute. Values of whole-number types are rounded to the nearest,
/// halves to even.
class SetAttribute final : public LocalOperator {
 public:
  /// `type`: type of a new attribute, or of an attribute of the input that is assigned without a condition. If absent,
  /// a new attribute gets the type of the LAS field with its name, else float64.
  SetAttribute(Assignment assignment, std::optional<Type> type, std::string place)
      : assignment_(std::move(assignment)), type_(type), place_(std::move(place)) {
    target_ = scalar(assignment_.name, Type::f64, "1", "assigned");
    set_options().declare(*this, {assignment_.canonical(), type});
  }
  std::string name() const override { return "set"; }
  Contract contract() const override;
  /// Throws RowError naming the lowest row of the batch with a value that the type of the attribute cannot hold.
  void apply(const Neighborhoods& in, Columns& out) const override {
    with_type(target_.type, [&]<class T>() { assign<T>(in, out); });
  }
  std::array<bool, 3> changes_system() const override { return {component_ == 0, component_ == 1, component_ == 2}; }
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  void find_target(const Schema& input, std::span<const Attribute> made);
  /// Returns the index, in contract().reads, of the first attribute that the condition reads. The attributes that the
  /// value reads come before it.
  std::size_t first_of_condition() const { return value_names_.reads().size(); }
  RowSentence refusal(const std::string& value) const;
  RowSentence inexact() const;
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
  bool is_retyped_ = false;  ///< true if target_ has another type than the attribute of the input
  std::optional<Attribute> old_;
  std::optional<std::size_t> old_value_;
};

/// Several assignments in order: each reads the results of the assignments before it.
class Set final : public CompositeOperator {
 public:
  Set(std::string_view assignments, std::optional<Type> type, const std::string& place = "set") {
    std::string canonical;
    for (const Assignment& a : assignments_of(assignments, place)) {
      parts_.push_back(std::make_shared<SetAttribute>(a, type, place));
      canonical += (canonical.empty() ? "" : ", ") + a.canonical();
    }
    set_options().declare(*this, {canonical, type});
  }
  std::string name() const override { return "set"; }
  Contract contract() const override {
    Contract contract{.default_k = 0};
    for (const auto& part : parts_)
      for (const Attribute& a : contract_of(part).makes) contract.makes.push_back(a);
    return contract;
  }
  std::vector<ChainStage> parts() const override { return parts_; }

 private:
  std::vector<ChainStage> parts_;
};

ChainStage make_set(const OptionValues& values, const Facts&) {
  const SetOptions options = set_options().read(values);
  return std::make_shared<Set>(options.assign, options.as, values.where());
}

}  // namespace

OperatorDeclaration set_declaration() {
  return {
      .name = "set",
      .meaning = "assigns numbers to attributes, of all points or of those for which a condition holds",
      .options = set_options().declarations(),
      .make = make_set,
      .formula =
          "Numbers are evaluated in float64, as by where; an attribute of whole numbers of 64 bits, or a whole "
          "number, is assigned exactly. A whole-number type gets the nearest one, halves to even.\n"
          "An attribute that exists keeps its type (one of the input gets the type of 'as' if no condition is given, "
          "and scaled numbers, as those of LAS, become float64), "
          "and its value where the condition does not hold; a new attribute is 0 there. Assigning to x, y or z moves "
          "the points.",
      .undefined =
          "A value that the type cannot hold ends the run with an error that names the row, and so does "
          "arithmetic with attributes of 64-bit integers, for a type of 64 bits, where they or the result are beyond "
          "2^53 and float64 may round; and so does a NaN or infinite coordinate for a point that has a finite place. "
          "Points without a finite place are assigned to like "
          "all others.",
      .cost = "a pass over the rows, without a search; none where other stages search anyway",
      .makes_named = true,
      .example = "knn(k=12) | sor | set(classification = 7 where outlier == 1)"};
}

ChainStage operators::set(std::string_view assignments, std::optional<Type> type) {
  return std::make_shared<Set>(assignments, type);
}

std::string Assignment::canonical() const {
  const std::string text = fmt::format("{} = {}", spelled_name(name), value.canonical());
  return condition ? fmt::format("{} where {}", text, condition->canonical()) : text;
}

std::vector<Assignment> assignments_of(std::string_view text, const std::string& place) {
  const std::string hidden = with_hidden_names(text);
  std::vector<Assignment> assignments;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = end_of_assignment(hidden, begin);
    assignments.push_back(assignment_of(text.substr(begin, end - begin), place));
    begin = end + 1;
  }
  return assignments;
}

Contract SetAttribute::contract() const {
  Contract contract{.makes = {target_}, .default_k = 0};
  const auto add = [&](const std::vector<Attribute>& reads) {
    contract.reads.insert(contract.reads.end(), reads.begin(), reads.end());
  };
  add(value_names_.reads());
  add(condition_names_.reads());
  if (old_) contract.reads.push_back(*old_);
  return contract;
}

std::shared_ptr<const LocalOperator> SetAttribute::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<SetAttribute>(*this);
  bound->value_names_ = NamedValues(assignment_.value, place_, input, made);
  if (assignment_.condition) bound->condition_names_ = NamedValues(*assignment_.condition, place_, input, made);
  bound->find_target(input, made);
  if (bound->old_) bound->old_value_ = bound->first_of_condition() + bound->condition_names_.reads().size();
  return bound;
}

/// Finds the target: a made attribute, a coordinate, a field of the input, or a new attribute.
void SetAttribute::find_target(const Schema& input, std::span<const Attribute> made) {
  const std::string& name = assignment_.name;
  if (const auto axis = axis_of(name); axis && meant_value(name, {}, made).made == nullptr) {
    target_ = position_attribute();
    component_ = *axis;
    range_ = range_of(Type::f64);
    return;
  }
  if (std::optional<AssignedTarget> known = target_of(name, input, made, place_)) {
    target_ = std::move(known->made), component_ = known->component, range_ = known->range;
    const bool is_of_input = !makes(made, target_.name);
    if (type_ && *type_ != range_.type && is_of_input && !assignment_.condition) {
      range_ = range_of(*type_);
      target_ = scalar(target_.name, *type_, "1", "assigned");
      is_retyped_ = true;
    } else {
      old_ = std::move(known->old);
    }
    return;
  }
  // A new "b" is an attribute of the user and not the blue of a colour that the cloud does not have.
  const auto las = std::ranges::find(kTypesOfLas, name.size() == 1 ? name : library_name_of(name), &LasType::first);
  range_ = range_of(type_ ? *type_ : las != std::end(kTypesOfLas) ? las->second : Type::f64);
  target_ = scalar(name, range_.type, "1", "assigned");
}

RowSentence SetAttribute::refusal(const std::string& value) const {
  const bool moves = target_.name == position_attribute().name;
  std::string remedy = "exclude such points by a condition, or assign to a new attribute";
  if (is_retyped_)
    remedy = fmt::format("state a type that holds it with 'as', or limit it, as in {} = min(max({}, LEAST), MOST)",
                         spelled_name(assignment_.name), assignment_.value.canonical());
  return {fmt::format("{}: row ", place_), fmt::format(": {} would be {}, which is not {}; {}.", assignment_.name,
                                                       value, moves ? "a finite coordinate" : range_.text(), remedy)};
}

/// `is_placed`: true if the point has a finite place, which the assignment must not make infinite or NaN.
template <class T>
std::optional<T> SetAttribute::stored(double value, bool is_placed) const {
  if constexpr (std::is_floating_point_v<T>) {
    const auto as_stored = static_cast<T>(value);
    const bool moves = is_placed && target_.name == position_attribute().name;
    if ((std::isfinite(value) || moves) && !std::isfinite(as_stored)) return std::nullopt;
    return as_stored;
  } else {
    return whole_in<T>(range_, std::nearbyint(value));
  }
}

/// Returns the error about a whole number that arithmetic in float64 may have rounded.
RowSentence SetAttribute::inexact() const {
  return {
      fmt::format("{}: row ", place_),
      fmt::format(": {} is computed with whole numbers beyond 2^53, which arithmetic in float64 rounds; assign to a "
                  "float64 attribute, or exclude such points by a condition.",
                  assignment_.name)};
}

template <class T>
void SetAttribute::assign(const Neighborhoods& in, Columns& out) const {
  const std::size_t n = in.size(), width = target_.fields.size();
  const NamedValues::Batch batch(value_names_, in, 0);
  std::vector<std::uint8_t> holds(n, 1);
  if (assignment_.condition) {
    const NamedValues::Batch names(condition_names_, in, first_of_condition());
    assignment_.condition->evaluate(names.values(), holds);
  }
  const bool is_exact = std::is_integral_v<T> && assignment_.value.is_whole(batch.values());
  std::vector<WholeNumber> wholes(is_exact ? n : 0);
  std::vector<double> reals(is_exact ? 0 : n);
  if (is_exact)
    assignment_.value.evaluate_whole(batch.values(), wholes);
  else
    assignment_.value.evaluate_number(batch.values(), reals);
  auto* const to = reinterpret_cast<T*>(out.column<std::byte>(0).data());
  const Field old_field{.name = "", .type = old_ ? old_->type : Type::f64};
  const auto old = old_value_ ? in.values<std::byte>(*old_value_) : nullptr;
  FirstRowError refused;
  const auto refuse = [&](std::size_t i, const auto& value) {
    refused.note(in.row(i), [&] { return refusal(value()); });
  };
  for (std::size_t i = 0; i < n; ++i) {
    T* const value = to + i * width;
    for (std::size_t c = 0; c < width; ++c) {
      if (target_.name == position_attribute().name) {
        value[c] = static_cast<T>(in.position(i)[static_cast<int>(c)]);
      } else if (old != nullptr) {
        const std::byte* const from = old + i * old_->bytes() + c * size_of(old_->type);
        if (old_->type == target_.type)
          std::memcpy(value + c, from, sizeof(T));
        else
          value[c] = static_cast<T>(value_of(old_field, from));
      }
    }
    if (!holds[i]) continue;
    if (!is_exact) {
      const std::optional<T> number = stored<T>(reals[i], is_finite(in.position(i)));
      if (number && std::is_integral_v<T> && sizeof(T) == 8 && may_be_rounded(batch.values(), i, reals[i]))
        refused.note(in.row(i), [&] { return inexact(); });
      else if (number)
        value[component_] = *number;
      else
        refuse(i, [&] { return std::isnan(reals[i]) ? "nan" : fmt::format("{}", reals[i]); });
      continue;
    }
    if constexpr (std::is_integral_v<T>) {
      if (const std::optional<T> number = whole_in<T>(range_, wholes[i]))
        value[component_] = *number;
      else
        refuse(i, [&] { return fmt::format("{:.0f}", static_cast<double>(wholes[i])); });
    }
  }
  refused.throw_if_any();
}

}  // namespace pointsweep
