// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/kept_fields.h"

#include <algorithm>
#include <numeric>
#include <ranges>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/points/lower_case.h"
#include "pointsweep/program/nearest_names.h"

namespace pointsweep {
namespace {

/// Collects the fields that names mean. add() takes one name.
class Selection {
 public:
  Selection(const std::vector<Attribute>& made, const Schema& input, std::string done = "kept")
      : made_(made), input_(input), done_(std::move(done)) {}

  NamedFields named() const { return {made_fields_, input_fields_}; }

  void add(const std::string& name) {
    const std::string word = in_lower_case(name);
    const auto is_name = [&](const std::string& field) { return field == name; };
    const auto is_spelling = [&](const std::string& field) { return is_spelling_of(field, word); };
    const bool found =
        add_made(name, is_name) || add_input(is_name) || add_made(word, is_spelling) || add_input(is_spelling);
    const auto axis = std::ranges::find(kAxisNames, word);
    if (axis != kAxisNames.end() && input_.find(*axis)) input_fields_.insert(*input_.find(*axis));
    if (!found) refuse(name);
  }

  KeptFields result() const {
    KeptFields kept;
    kept.order = order_;
    const std::set<std::size_t> input = input_indices();
    for (const Attribute& a : made_) {
      const bool moved = a.name == position_attribute().name;
      const auto is_named = [&](const std::string& field) { return moved || made_fields_.contains(field); };
      if (!made_fields_.empty() && std::ranges::none_of(a.fields, is_named)) continue;
      kept.attributes.push_back(a.name);
      for (const std::string& field : a.fields)
        if (!made_fields_.empty() && !is_named(field)) kept.left_out.insert(field);
    }
    if (input.size() < input_.fields.size()) kept.input.emplace(input.begin(), input.end());
    return kept;
  }

 private:
  /// Adds the made fields that match `fits`, or all fields of the attribute named `attribute`. If one moved coordinate
  /// matches, adds all three. Returns whether there was a match.
  template <class Fits>
  bool add_made(const std::string& attribute, Fits fits) {
    bool any = false;
    for (const Attribute& a : made_) {
      const bool whole =
          a.name == attribute || (a.name == position_attribute().name && std::ranges::any_of(a.fields, fits));
      for (const std::string& field : a.fields)
        if (whole || fits(field)) any = true, made_fields_.insert(field);
      for (const std::string& field : a.fields)
        if (a.name == attribute || fits(field)) append(field);
    }
    return any;
  }

  /// Adds the fields of the input whose name, or column name in outputs, matches `fits`.
  template <class Fits>
  bool add_input(Fits fits) {
    bool any = false;
    const std::vector<std::string> columns = column_names(input_);
    auto column = columns.begin();
    for (std::size_t f = 0; f < input_.fields.size(); ++f) {
      const auto end = column + input_.fields[f].count;
      if (fits(input_.fields[f].name) || std::any_of(column, end, fits))
        any = true, input_fields_.insert(f), append(input_.fields[f].name);
      column = end;
    }
    return any;
  }

  void append(const std::string& field) {
    if (std::ranges::find(order_, field) == order_.end()) order_.push_back(field);
  }

  /// Returns the named fields of the input and the coordinates; all fields if none is named.
  std::set<std::size_t> input_indices() const {
    std::set<std::size_t> indices = input_fields_;
    for (std::size_t f = 0; input_fields_.empty() && f < input_.fields.size(); ++f) indices.insert(f);
    for (const char* axis : kAxisNames)
      if (const auto at = input_.find(axis)) indices.insert(*at);
    return indices;
  }

  [[noreturn]] void refuse(const std::string& name) const {
    std::vector<std::string> made, all;
    for (const Attribute& a : made_) made.push_back(a.name);
    all = made;
    for (const Attribute& a : made_) all.insert(all.end(), a.fields.begin(), a.fields.end());
    const auto names = input_.fields | std::views::transform(&Field::name);
    all.insert(all.end(), names.begin(), names.end());
    const auto meant = probable_name(name, all);
    fail_usage("'{}' cannot be {}{}; the input has {}{}.", name, done_,
               meant ? fmt::format(" (did you mean '{}'?)", *meant) : "", fmt::join(names, ", "),
               made.empty() ? "" : fmt::format(", and what is made is {}", fmt::join(made, ", ")));
  }

  const std::vector<Attribute>& made_;
  const Schema& input_;
  std::string done_;
  std::set<std::string> made_fields_;   ///< named made fields; empty: all
  std::set<std::size_t> input_fields_;  ///< named fields of the input; empty: all
  std::vector<std::string> order_;
};

}  // namespace

Schema in_named_order(Schema schema, const KeptFields& kept, const std::vector<Attribute>& made) {
  const auto is_coordinate = [](const std::string& name) { return name == "x" || name == "y" || name == "z"; };
  const bool all_coordinates = std::ranges::count_if(kept.order, is_coordinate) == 3;
  const auto rank = [&](const Field& field) {
    if (is_coordinate(field.name) && !all_coordinates) return std::ptrdiff_t{0};
    const auto named = std::ranges::find(kept.order, field.name);
    if (named != kept.order.end()) return 1 + (named - kept.order.begin());
    const bool is_made = std::ranges::any_of(made, [&](const Attribute& a) {
      return a.name != position_attribute().name && std::ranges::find(a.fields, field.name) != a.fields.end();
    });
    return is_made ? 1 + std::ssize(kept.order) : std::ptrdiff_t{0};
  };
  if (!kept.order.empty()) std::ranges::stable_sort(schema.fields, {}, rank);
  return schema;
}

KeptFields without_replaced(KeptFields kept, const Schema& input) {
  std::set<std::size_t> replaced;
  for (const std::string& field : kept.left_out)
    if (const auto at = input.find(field)) replaced.insert(*at);
  if (replaced.empty()) return kept;
  if (!kept.input) kept.input.emplace(input.fields.size()), std::iota(kept.input->begin(), kept.input->end(), 0u);
  std::erase_if(*kept.input, [&](std::size_t f) { return replaced.contains(f); });
  return kept;
}

std::vector<std::string> without_prefix(std::vector<std::string> names, const std::string& prefix,
                                        const std::vector<Attribute>& made) {
  const auto made_name = [&](const std::string& word) -> std::optional<std::string> {
    for (const Attribute& a : made) {
      if (a.name == position_attribute().name) continue;
      if (a.name == word) return word;
      for (const std::string& field : a.fields)
        if (is_spelling_of(field, word)) return field;
    }
    return std::nullopt;
  };
  for (std::string& name : names) {
    if (prefix.empty() || !in_lower_case(name).starts_with(in_lower_case(prefix))) continue;
    if (const auto own = made_name(in_lower_case(name.substr(prefix.size())))) name = *own;
  }
  return names;
}

NamedFields named_fields(const std::vector<std::string>& names, const std::vector<Attribute>& made, const Schema& input,
                         const std::string& done) {
  Selection selection(made, input, done);
  for (const std::string& name : names) selection.add(name);
  return selection.named();
}

KeptFields kept_fields(const std::vector<std::string>& names, const std::vector<Attribute>& made, const Schema& input) {
  Selection selection(made, input);
  for (const std::string& name : names) selection.add(name);
  return selection.result();
}

}  // namespace pointsweep
