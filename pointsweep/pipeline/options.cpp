// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/nearest_names.h"

namespace pointsweep {
namespace {

template <class Number>
std::optional<Number> read_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<Vec3> read_point(std::string_view text) {
  Vec3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t end = axis < 2 ? text.find(',') : text.size();
    const auto number = end == text.npos ? std::nullopt : read_number<double>(text.substr(0, end));
    if (!number || !std::isfinite(*number)) return std::nullopt;
    point[axis] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return point;
}

bool may_be(const OptionDeclaration& option, std::string_view value) {
  switch (option.kind) {
    case OptionKind::whole: {
      const auto number = read_number<std::uint64_t>(value);
      return number && double(*number) >= option.least && double(*number) <= option.most;
    }
    case OptionKind::number: {
      const auto number = read_number<double>(value);
      return number && std::isfinite(*number) && *number >= option.least && *number <= option.most;
    }
    case OptionKind::choice:
      return std::find(option.choices.begin(), option.choices.end(), value) != option.choices.end();
    case OptionKind::point:
      return read_point(value).has_value();
    case OptionKind::attribute:
      return !value.empty();
  }
  return false;
}

std::string range_text(double least, double most) {
  return std::isfinite(most) ? fmt::format("{} to {}", least, most) : fmt::format("{} or more", least);
}

/// What is written without a name: a value, or the name of an option alone.
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
  if (names.empty()) fail_usage("{}: {} has no options, so it has no '{}'.", option.place, stage, option.name);
  fail_usage("{}: {} has no option '{}'; the nearest it has {} {}.", option.place, stage, option.name,
             names.size() == 1 ? "is" : "are", nearest_names(option.name, names));
}

}  // namespace

std::string OptionDeclaration::allowed() const {
  switch (kind) {
    case OptionKind::whole:
    case OptionKind::number:
      return range_text(least, most);
    case OptionKind::point:
      return "[X,Y,Z]";
    case OptionKind::attribute:
      return "the name of an attribute";
    case OptionKind::choice:
      break;
  }
  std::string text;
  for (std::size_t i = 0; i < choices.size(); ++i)
    text += (i == 0 ? "" : i + 1 == choices.size() ? " or " : ", ") + choices[i];
  return text;
}

void OptionDeclaration::check(std::string_view value, std::string_view where) const {
  if (may_be(*this, value)) return;
  const char* what = kind == OptionKind::whole    ? "a whole number, "
                     : kind == OptionKind::number ? "a number, "
                     : kind == OptionKind::point  ? "three numbers "
                                                  : "";
  fail_usage("{}: {} is {}{}, not '{}'.", where, name, what, allowed(), value);
}

OptionValues::OptionValues(const std::vector<OptionDeclaration>& declarations, const StageText& stage)
    : where_(stage.place + ": " + stage.name) {
  for (const OptionText& option : stage.options) {
    declared(declarations, option, stage.name).check(option.value, option.place + ": " + stage.name);
    if (!given_.emplace(option.name, option.value).second)
      fail_usage("{}: {}: '{}' is given twice.", option.place, stage.name, option.name);
  }
  for (const OptionDeclaration& d : declarations)
    if (!given(d.name) && !d.preset.empty()) preset_.emplace(d.name, d.preset);
}

OptionValues OptionValues::with_presets_of(const std::vector<OptionDeclaration>& declarations) const {
  OptionValues values = *this;
  for (const OptionDeclaration& d : declarations)
    if (!given(d.name) && !d.preset.empty()) values.preset_.insert_or_assign(d.name, d.preset);
  return values;
}

const std::string& OptionValues::choice(std::string_view name) const {
  const auto found = given_.find(name);
  return found != given_.end() ? found->second : preset_.find(name)->second;
}

// Whatever is read here has been checked.
std::uint64_t OptionValues::whole(std::string_view name) const { return *read_number<std::uint64_t>(choice(name)); }
double OptionValues::number(std::string_view name) const { return *read_number<double>(choice(name)); }
Vec3 OptionValues::point(std::string_view name) const { return *read_point(choice(name)); }

}  // namespace pointsweep
