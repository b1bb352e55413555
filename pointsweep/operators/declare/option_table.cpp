// SPDX-License-Identifier: MIT
#include "pointsweep/operators/declare/option_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pointsweep/fail.h"

namespace pointsweep {

OptionValue value_of_member(const std::string& text, const ChoiceWords&) {
  return text.empty() ? OptionValue() : OptionValue(text);
}

OptionValue value_of_member(const std::vector<std::string>& words, const ChoiceWords&) {
  return words.empty() ? OptionValue() : OptionValue(fmt::format("{}", fmt::join(words, ",")));
}

OptionValue value_of_member(const std::vector<double>& numbers, const ChoiceWords&) {
  return numbers.empty() ? OptionValue() : OptionValue(text_of_numbers(numbers));
}

void set_member(std::vector<std::string>& words, const OptionValue& value, const ChoiceWords&) {
  words = words_of(std::get<std::string>(value));
}

void set_member(std::vector<double>& numbers, const OptionValue& value, const ChoiceWords&) {
  numbers = numbers_of(std::get<std::string>(value));
}

void require_allowed(const OptionDeclaration& option, const OptionValue& value, const std::string& where) {
  if (has_value(value) && !option.allows(value)) option.refuse(text_of_value(value), where);
  if (option.required && !has_value(value)) fail_usage("{}: the option '{}' is missing.", where, option.name);
}

}  // namespace pointsweep
