// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"
#include "pointsweep/program/declaration.h"
#include "pointsweep/program/nearest_names.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

std::optional<Vec3> read_point(std::string_view text) {
  Vec3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',') : text.size();
    const auto number = end == text.npos ? std::nullopt : number_from<double>(text.substr(0, end));
    if (!number) return std::nullopt;
    point[axis] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return point;
}

/// Throws UsageError for an option without `=`, which is a value without a name or a name without a value.
[[noreturn]] void refuse_unnamed(const std::vector<OptionDeclaration>& declarations, const OptionText& option,
                                 const std::string& stage) {
  const auto named = std::ranges::find(declarations, option.value, &OptionDeclaration::name);
  if (named != declarations.end())
    fail_usage("{}: {}: the option '{}' has no value; write {}=VALUE ({}).", option.place, stage, option.value,
               option.value, named->allowed());
  if (declarations.empty()) fail_usage("{}: {} has no options; leave out '{}'.", option.place, stage, option.value);
  fail_usage("{}: {}: '{}' has no name; write options as NAME=VALUE, e.g. {}={}.", option.place, stage, option.value,
             declarations.front().name, option.value);
}

const OptionDeclaration& declared(const std::vector<OptionDeclaration>& declarations, const OptionText& option,
                                  const std::string& stage) {
  if (option.name.empty()) refuse_unnamed(declarations, option, stage);
  std::vector<std::string> names;
  for (const OptionDeclaration& d : declarations) {
    if (d.name == option.name) return d;
    names.push_back(d.name);
  }
  const auto& knn = neighborhood_declaration();
  if (std::ranges::find(knn.options, option.name, &OptionDeclaration::name) != knn.options.end())
    fail_usage("{}: {} belongs to the neighbourhood: write {}({}={}) | {}.", option.place, option.name, knn.name,
               option.name, option.value, stage);
  if (names.empty()) fail_usage("{}: {} has no options, so it has no '{}'.", option.place, stage, option.name);
  fail_usage("{}: {} has no option '{}'; the nearest it has {} {}.", option.place, stage, option.name,
             names.size() == 1 ? "is" : "are", nearest_names(option.name, names));
}

/// Returns the declaration that an option text belongs to. If the first option text has no name, it belongs to the
/// first declaration, unless its value is the name of an option that cannot be given without its name.
const OptionDeclaration& declared_for(const std::vector<OptionDeclaration>& declared_options, const OptionText& option,
                                      bool first, const StageText& stage) {
  const auto is_name = [&](const OptionDeclaration& o) { return !o.positional && o.name == option.value; };
  if (option.name.empty() && first && !declared_options.empty() && std::ranges::none_of(declared_options, is_name))
    return declared_options.front();
  return declared(declared_options, option, stage.name);
}

/// Treats where(level = 3) as a condition with a typing error instead of an option `level`.
OptionText as_condition(const std::vector<OptionDeclaration>& declared_options, const OptionText& option) {
  const bool takes_one = !declared_options.empty() && declared_options.front().kind == OptionKind::condition &&
                         declared_options.front().positional;
  const bool is_known =
      std::ranges::find(declared_options, option.name, &OptionDeclaration::name) != declared_options.end();
  if (option.name.empty() || is_known || !takes_one) return option;
  return {"", option.name + " = " + option.value, option.place};
}

/// Joins the unnamed values of drop(a, b) or of set(a = 1, b = 2) to one value with commas, since the first option of
/// these stages is a list.
std::vector<OptionText> with_lists_joined(const std::vector<OptionDeclaration>& declared_options,
                                          const std::vector<OptionText>& given) {
  const auto is_list = [](const OptionDeclaration& option) {
    return option.positional && (option.kind == OptionKind::attributes || option.kind == OptionKind::assignments);
  };
  if (declared_options.empty() || !is_list(declared_options.front())) return given;
  std::vector<OptionText> joined;
  for (const OptionText& option : given) {
    const bool goes_on = !joined.empty() && joined.front().name.empty() && option.name.empty();
    goes_on ? void(joined.front().value += "," + option.value) : joined.push_back(option);
  }
  return joined;
}

std::optional<OptionValue> parse_unchecked(OptionKind kind, std::string_view text) {
  const auto value = [](const auto& parsed) { return parsed ? std::optional<OptionValue>(*parsed) : std::nullopt; };
  switch (kind) {
    case OptionKind::whole:
      return value(number_from<std::uint64_t>(text));
    case OptionKind::number:
      return value(number_from<double>(text));
    case OptionKind::point:
      return value(read_point(text));
    case OptionKind::numbers:
      return text_of_numbers(numbers_of(text));
    case OptionKind::choice:
    case OptionKind::file:
    case OptionKind::matrix:
    case OptionKind::word:
    case OptionKind::attributes:
    case OptionKind::assignments:
    case OptionKind::names:
    case OptionKind::attribute:
    case OptionKind::condition:
      break;
  }
  return std::string(text);
}

}  // namespace

std::optional<OptionValue> parse_value(const OptionDeclaration& option, std::string_view text) {
  std::optional<OptionValue> value = parse_unchecked(option.kind, text);
  if (value && !option.allows(*value)) value.reset();
  return value;
}

OptionValues read_options(const std::vector<OptionDeclaration>& declared_options, const StageText& stage) {
  OptionValues values(declared_options, stage.place + ": " + stage.name);
  const std::vector<OptionText> options = with_lists_joined(declared_options, stage.options);
  for (const OptionText& given : options) {
    const OptionText text = as_condition(declared_options, given);
    const OptionDeclaration& option = declared_for(declared_options, text, &given == options.data(), stage);
    std::optional<OptionValue> value = parse_value(option, text.value);
    if (!value) option.refuse(text.value, text.place + ": " + stage.name);
    if (!values.give(option.name, *std::move(value)))
      fail_usage("{}: {}: '{}' is given twice.", text.place, stage.name, option.name);
  }
  for (const OptionDeclaration& option : declared_options)
    if (option.required && !values.given(option.name))
      fail_usage("{}: the option '{}' is missing; write {}({}{}).", values.where(), option.name, stage.name,
                 option.positional ? "" : option.name + "=", text_of_value(option.sample));
  return values;
}

}  // namespace pointsweep
