// SPDX-License-Identifier: MIT
/// The options of an operator as one table: name, meaning, range and unit of each member of the options' struct.
/// Defaults are the member initializers of the struct. The declared options, the options of a stage of a pipeline, the
/// check of ranges and the options in records all come from the table.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {

/// The words of a choice, in the order of its values.
using ChoiceWords = std::vector<std::string>;

template <class Member>
concept IsChoice = std::is_enum_v<Member> || std::is_same_v<Member, bool>;

/// Returns the value of a member of an options' struct; std::monostate for an empty text, an empty list or an absent
/// optional.
inline OptionValue value_of_member(const std::string& text, const ChoiceWords&) {
  return text.empty() ? OptionValue() : OptionValue(text);
}
inline OptionValue value_of_member(const std::vector<std::string>& words, const ChoiceWords&) {
  return words.empty() ? OptionValue() : OptionValue(list_of_words(words));
}
inline OptionValue value_of_member(const std::vector<double>& numbers, const ChoiceWords&) {
  return numbers.empty() ? OptionValue() : OptionValue(text_of_numbers(numbers));
}
inline OptionValue value_of_member(double number, const ChoiceWords&) { return number; }
inline OptionValue value_of_member(std::uint64_t number, const ChoiceWords&) { return number; }
inline OptionValue value_of_member(Vec3 point, const ChoiceWords&) { return point; }
template <IsChoice Choice>
OptionValue value_of_member(Choice choice, const ChoiceWords& words) {
  return words.at(static_cast<std::size_t>(choice));
}
template <class Member>
OptionValue value_of_member(const std::optional<Member>& member, const ChoiceWords& words) {
  if (!member.has_value()) return {};
  return value_of_member(*member, words);
}

/// Sets a member to the value of an option. The value must have the kind of the member.
inline void set_member(std::vector<std::string>& words, const OptionValue& value, const ChoiceWords&) {
  words = words_of(std::get<std::string>(value));
}
inline void set_member(std::vector<double>& numbers, const OptionValue& value, const ChoiceWords&) {
  numbers = numbers_of(std::get<std::string>(value));
}
template <class Plain>
void set_member(Plain& member, const OptionValue& value, const ChoiceWords&) {
  member = std::get<Plain>(value);
}
template <IsChoice Choice>
void set_member(Choice& choice, const OptionValue& value, const ChoiceWords& words) {
  std::size_t place = 0;
  while (words.at(place) != std::get<std::string>(value)) ++place;
  choice = static_cast<Choice>(place);
}
template <class Member>
void set_member(std::optional<Member>& member, const OptionValue& value, const ChoiceWords& words) {
  set_member(member.emplace(), value, words);
}

/// The kind of an option whose member has the type Member; nullopt for texts and lists of words, whose kind is an
/// argument of option().
template <class Member>
inline constexpr std::optional<OptionKind> kKindOf = IsChoice<Member> ? std::optional(OptionKind::choice)
                                                                      : std::nullopt;
template <>
inline constexpr std::optional<OptionKind> kKindOf<double> = OptionKind::number;
template <>
inline constexpr std::optional<OptionKind> kKindOf<std::uint64_t> = OptionKind::whole;
template <>
inline constexpr std::optional<OptionKind> kKindOf<Vec3> = OptionKind::point;
template <>
inline constexpr std::optional<OptionKind> kKindOf<std::vector<double>> = OptionKind::numbers;
template <class Member>
inline constexpr std::optional<OptionKind> kKindOf<std::optional<Member>> = kKindOf<Member>;

/// A row of the table for the struct T: an option, with functions that read and set its member of a T.
template <class T>
struct OptionRow {
  OptionDeclaration declaration;
  std::function<OptionValue(const T&)> get;
  std::function<void(T&, const OptionValue&)> set;
};

/// Returns the row of the option that `member` holds. `more` has the limits, unit and sample of the option, the kind of
/// a text or of a list of words, and the words of a choice. The words of an enumeration have the order of its values;
/// the first of the two words of a truth value is the word of the default.
template <class T, class Member>
OptionRow<T> option(const char* name, Member T::*member, const char* meaning, OptionDeclaration more = {}) {
  more.name = name;
  more.meaning = meaning;
  more.kind = kKindOf<Member>.value_or(more.kind);
  ChoiceWords words = more.choices;
  const T presets;
  if constexpr (std::is_same_v<Member, bool>)
    if (presets.*member) std::swap(words.at(0), words.at(1));
  if (!more.required) more.preset = value_of_member(presets.*member, words);
  return {std::move(more), [member, words](const T& options) { return value_of_member(options.*member, words); },
          [member, words](T& options, const OptionValue& value) { set_member(options.*member, value, words); }};
}

/// Returns the row of an option that has a single choice, and so no member in the struct.
template <class T>
OptionRow<T> only_choice(const char* name, const char* word, const char* meaning) {
  return {{.name = name, .kind = OptionKind::choice, .preset = word, .meaning = meaning, .choices = {word}},
          [word](const T&) { return OptionValue(word); },
          [](T&, const OptionValue&) {}};
}

/// Throws UsageError, beginning with `where`, if a required option has no value, or if the value is not allowed.
inline void require_allowed(const OptionDeclaration& option, const OptionValue& value, const std::string& where) {
  if (has_value(value) && !option.allows(value)) option.refuse(text_of_value(value), where);
  if (option.required && !has_value(value)) fail_usage("{}: the option '{}' is missing.", where, option.name);
}

/// The options of an operator whose options' struct is T, in the order of its help.
template <class T>
class OptionTable {
 public:
  OptionTable(std::initializer_list<OptionRow<T>> rows) : rows_(rows) {}

  std::vector<OptionDeclaration> declarations() const {
    std::vector<OptionDeclaration> all;
    for (const OptionRow<T>& row : rows_) all.push_back(row.declaration);
    return all;
  }
  /// Returns the options of a stage of a pipeline.
  T read(const OptionValues& values) const {
    T options;
    for (const OptionRow<T>& row : rows_)
      if (const OptionValue* value = values.find(row.declaration.name)) row.set(options, *value);
    return options;
  }
  /// Gives an operator its declared options. Throws UsageError for a value that is not allowed and for a required
  /// option without a value.
  void declare(Operator& op, const T& options) const {
    Options declared;
    for (const OptionRow<T>& row : rows_) {
      OptionValue value = row.get(options);
      require_allowed(row.declaration, value, op.name());
      if (has_value(value)) declared.push_back({row.declaration.name, std::move(value)});
    }
    op.declare_options(std::move(declared));
  }
  /// Returns OperatorDeclaration::make for the class Made, whose constructor takes the options. A constructor that
  /// itself throws errors about its options also takes OptionValues::where(), with which their messages begin.
  template <class Made>
  auto maker() const {
    return [this](const OptionValues& values, const Facts&) -> ChainStage {
      if constexpr (std::is_constructible_v<Made, T, std::string>)
        return std::make_shared<Made>(read(values), values.where());
      else
        return std::make_shared<Made>(read(values));
    };
  }

 private:
  std::vector<OptionRow<T>> rows_;
};

}  // namespace pointsweep
