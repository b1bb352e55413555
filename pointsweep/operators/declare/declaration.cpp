// SPDX-License-Identifier: MIT
#include "pointsweep/program/declaration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"
#include "pointsweep/operators/kinds/stage_operator.h"

namespace pointsweep {
namespace {

bool is_within(double value, const OptionDeclaration& option) { return value >= option.least && value <= option.most; }

std::string range_text(double least, double most) {
  if (least == kAboveZero) return std::isfinite(most) ? fmt::format("above 0, at most {}", most) : "above 0";
  if (!std::isfinite(least)) return "finite";
  return std::isfinite(most) ? fmt::format("{} to {}", least, most) : fmt::format("{} or more", least);
}

std::string choices_text(const std::vector<std::string>& choices, const char* last = " or ") {
  std::string text;
  for (std::size_t i = 0; i < choices.size(); ++i)
    text += (i == 0 ? "" : i + 1 == choices.size() ? last : ", ") + choices[i];
  return text;
}

bool is_letter_or_digit(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool are_some_of(const std::vector<std::string>& words, const std::vector<std::string>& choices) {
  const std::set<std::string> distinct(words.begin(), words.end());
  return !words.empty() && distinct.size() == words.size() && std::ranges::all_of(words, [&](const std::string& word) {
    return std::ranges::find(choices, word) != choices.end();
  });
}

/// Returns the shortest text of a number, with 0 for -0.
std::string shortest_text(double number) { return fmt::format("{}", number == 0 ? 0.0 : number); }

}  // namespace

std::string OptionDeclaration::allowed() const {
  switch (kind) {
    case OptionKind::whole:
    case OptionKind::number:
      return range_text(least, most);
    case OptionKind::choice:
      return choices_text(choices);
    case OptionKind::names:
      return fmt::format("a list of {}, each at most once", choices_text(choices, " and "));
    case OptionKind::point:
      return "[X,Y,Z]";
    case OptionKind::attribute:
      return "the name of an attribute";
    case OptionKind::numbers:
      return "a list of numbers, [A,B,...]";
    case OptionKind::file:
      return "the name of a file";
    case OptionKind::matrix:
      return "4 rows of 4 numbers, or the name of a file that holds them";
    case OptionKind::word:
      return "a word of letters and digits";
    case OptionKind::attributes:
      return "names of attributes with commas between";
    case OptionKind::assignments:
      return "assignments such as classification = 7 where outlier == 1";
    case OptionKind::condition:
      break;
  }
  return "a condition such as classification == 2 && z < 100";
}

bool OptionDeclaration::allows(const OptionValue& value) const {
  const auto* whole = std::get_if<std::uint64_t>(&value);
  const auto* number = std::get_if<double>(&value);
  const auto* word = std::get_if<std::string>(&value);
  const auto* point = std::get_if<Vec3>(&value);
  switch (kind) {
    case OptionKind::whole:
      return whole != nullptr && is_within(static_cast<double>(*whole), *this);
    case OptionKind::number:
      return number != nullptr && std::isfinite(*number) && is_within(*number, *this);
    case OptionKind::choice:
      return word != nullptr && std::ranges::find(choices, *word) != choices.end();
    case OptionKind::names:
      return word != nullptr && are_some_of(words_of(*word), choices);
    case OptionKind::point:
      return point != nullptr && is_finite(*point);
    case OptionKind::numbers:
      return word != nullptr && !numbers_of(*word).empty();
    case OptionKind::word:
      return word != nullptr && !word->empty() && std::ranges::all_of(*word, is_letter_or_digit);
    case OptionKind::attributes:
      return word != nullptr && std::ranges::none_of(words_of(*word), &std::string::empty);
    case OptionKind::attribute:
    case OptionKind::condition:
    case OptionKind::file:
    case OptionKind::matrix:
    case OptionKind::assignments:
      break;
  }
  return word != nullptr && !word->empty();
}

void OptionDeclaration::refuse(const std::string& value, const std::string& where) const {
  const char* what = kind == OptionKind::whole    ? "a whole number, "
                     : kind == OptionKind::number ? "a number, "
                     : kind == OptionKind::point  ? "three numbers "
                                                  : "";
  fail_usage("{}: {} is {}{}, not '{}'.", where, name, what, allowed(), value);
}

std::string text_of_value(const OptionValue& value) {
  if (const auto* whole = std::get_if<std::uint64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&value)) return shortest_text(*number);
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  if (const auto* p = std::get_if<Vec3>(&value)) return text_of_numbers({p->x, p->y, p->z});
  return "";
}

OptionValues::OptionValues(const std::vector<OptionDeclaration>& declared, std::string where)
    : where_(std::move(where)) {
  for (const OptionDeclaration& option : declared)
    if (has_value(option.preset)) preset_.emplace(option.name, option.preset);
}

bool OptionValues::give(const std::string& name, OptionValue value) {
  return given_.emplace(name, std::move(value)).second;
}

OptionValues OptionValues::with_presets_of(const std::vector<OptionDeclaration>& declared) const {
  OptionValues values(declared, where_);
  values.given_ = given_;
  return values;
}

const OptionValue* OptionValues::find(std::string_view name) const {
  if (const auto found = given_.find(name); found != given_.end()) return &found->second;
  const auto preset = preset_.find(name);
  return preset != preset_.end() ? &preset->second : nullptr;
}

std::vector<std::string> words_of(std::string_view list) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t close = begin < list.size() && list[begin] == '`' ? list.find('`', begin + 1) : list.npos;
    const bool is_quoted = close != list.npos && (close + 1 == list.size() || list[close + 1] == ',');
    const std::size_t end = is_quoted ? close + 1 : std::min(list.find(',', begin), list.size());
    words.emplace_back(is_quoted ? list.substr(begin + 1, close - begin - 1) : list.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

std::string list_of_words(const std::vector<std::string>& words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const char* const quote = words[i].find(',') != std::string::npos ? "`" : "";
    list += fmt::format("{}{}{}{}", i == 0 ? "" : ",", quote, words[i], quote);
  }
  return list;
}

std::vector<double> numbers_of(std::string_view list) {
  std::vector<double> numbers;
  for (const std::string& word : words_of(list)) {
    const auto number = number_from<double>(word);
    if (!number || !std::isfinite(*number)) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

std::string text_of_numbers(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : ",") + shortest_text(number);
  return text;
}

OptionValues sample_values(const OperatorDeclaration& declaration) {
  OptionValues values(declaration.options, declaration.name);
  for (const OptionDeclaration& option : declaration.options)
    if (option.required || (option.positional && has_value(option.sample))) values.give(option.name, option.sample);
  return values;
}

Contract contract_of(const OperatorDeclaration& declaration) {
  const ChainStage stage = declaration.make(sample_values(declaration), {});
  Contract contract = contract_of(stage);
  std::erase_if(contract.makes, [](const Attribute& a) { return a.name == selection_attribute().name; });
  if (declaration.makes_named) contract.makes.clear();
  return contract;
}

}  // namespace pointsweep
