// SPDX-License-Identifier: MIT
#include "cli/text/operator_listing.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "cli/text/help.h"
#include "pointsweep/chain.h"
#include "pointsweep/error.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMeaningColumn = 17;  // column at which the meanings begin, to the right of the names

std::string listing_row(const std::string& name, const std::string& text) {
  return fmt::format("  {:<{}}{}\n", name, kMeaningColumn - 2, wrapped(text, kMeaningColumn));
}

std::string options_text(const std::vector<OptionDeclaration>& options) {
  std::string text;
  for (const OptionDeclaration& o : options) {
    const std::string preset = has_value(o.preset) ? fmt::format(" (default: {})", text_of_value(o.preset)) : "";
    text += listing_row(o.name, fmt::format("{}: {}{}", o.allowed(), o.meaning, preset));
  }
  return text;
}

/// Returns a text like "normal (nx ny nz float32), k1 (float32)".
std::string attribute_text(const std::vector<Attribute>& attributes) {
  std::string text;
  for (const Attribute& a : attributes) {
    text += (text.empty() ? "" : ", ") + a.name + " (";
    for (const std::string& field : a.fields)
      if (field != a.name) text += field + " ";
    text += fmt::format("{})", name_of(a.type));
  }
  return text;
}

std::string row_unless_empty(const char* what, const std::string& text) {
  return text.empty() ? "" : listing_row(what, text);
}

std::string formula_text(const std::string& formula) {
  std::string text;
  for (std::size_t begin = 0; begin < formula.size();) {
    const std::size_t end = std::min(formula.find('\n', begin), formula.size());
    text += listing_row(begin == 0 ? "formula" : "", formula.substr(begin, end - begin));
    begin = end + 1;
  }
  return text;
}

std::string operator_text(const ListedOperator& listed) {
  const OperatorDeclaration& d = listed.declaration;
  std::string text = fmt::format("{}: {}\n", d.name, wrapped(d.meaning, d.name.size() + 2));
  text += options_text(d.options);
  text += row_unless_empty("needs", attribute_text(listed.contract.reads));
  text += row_unless_empty("of neighbours", attribute_text(listed.contract.reads_neighbors));
  text += row_unless_empty("makes", attribute_text(listed.contract.makes));
  text += row_unless_empty("neighbours", default_k_text(listed));
  text += formula_text(d.formula);
  text += row_unless_empty("source", d.source) + row_unless_empty("undefined", d.undefined);
  return text + row_unless_empty("cost", d.cost) + row_unless_empty("example", d.example);
}

ListedOperator listed_neighborhood() {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  return {.declaration = {.name = knn.name,
                          .meaning = knn.meaning + "; the first stage of a pipeline, or left out",
                          .options = knn.options,
                          .make = {},
                          .formula = knn.formula,
                          .source = knn.source,
                          .cost = knn.cost,
                          .example = knn.example},
          .contract = {.default_k = 0}};
}

ListedOperator listed(const OperatorDeclaration& declaration) {
  return {.declaration = declaration, .contract = contract_of(declaration)};
}

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kKindsOfOptions[] = {"whole",     "number",     "choice",     "names", "point",
                                           "attribute", "condition",  "numbers",    "file",  "matrix",
                                           "word",      "attributes", "assignments"};
static_assert(std::size(kKindsOfOptions) == 1 + static_cast<std::size_t>(OptionKind::assignments));

OrderedJson json_of(const OptionValue& value) {
  if (const auto* whole = std::get_if<std::uint64_t>(&value)) return *whole;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  if (const auto* point = std::get_if<Vec3>(&value)) return {point->x, point->y, point->z};
  return nullptr;
}

/// Returns the limit as a JSON number; null if it is infinite, which means no limit.
OrderedJson json_of_limit(double limit) { return std::isfinite(limit) ? OrderedJson(limit) : OrderedJson(); }

OrderedJson json_of(const OptionDeclaration& option) {
  OrderedJson json = {{"name", option.name},
                      {"kind", kKindsOfOptions[static_cast<std::size_t>(option.kind)]},
                      {"default", json_of(option.preset)},
                      {"required", option.required},
                      {"meaning", option.meaning}};
  if (option.kind == OptionKind::whole || option.kind == OptionKind::number)
    json.update({{"range", {json_of_limit(option.least), json_of_limit(option.most)}}, {"allowed", option.allowed()}});
  if (!option.choices.empty()) json["choices"] = option.choices;
  if (!option.unit.empty()) json["unit"] = option.unit;
  return json;
}

OrderedJson json_of(const std::vector<Attribute>& attributes) {
  OrderedJson list = OrderedJson::array();
  for (const Attribute& a : attributes)
    list.push_back({{"name", a.name},
                    {"type", name_of(a.type)},
                    {"fields", a.fields},
                    {"unit", a.unit},
                    {"kind", kind_text(a)},
                    {"meaning", a.meaning}});
  return list;
}

OrderedJson json_of(const ListedOperator& listed) {
  const OperatorDeclaration& d = listed.declaration;
  OrderedJson options = OrderedJson::array();
  for (const OptionDeclaration& option : d.options) options.push_back(json_of(option));
  return {{"name", d.name},
          {"meaning", d.meaning},
          {"options", options},
          {"reads", json_of(listed.contract.reads)},
          {"reads_neighbors", json_of(listed.contract.reads_neighbors)},
          {"makes", json_of(listed.contract.makes)},
          {"default_k", listed.contract.default_k},
          {"formula", d.formula},
          {"source", d.source},
          {"undefined", d.undefined},
          {"cost", d.cost},
          {"example", d.example}};
}

}  // namespace

const char* kind_text(const Attribute& attribute) {
  constexpr const char* kKinds[] = {"position", "vector", "normal", "scalar", "index", "color"};
  return kKinds[static_cast<std::size_t>(attribute.kind)];
}

std::string default_k_text(const ListedOperator& listed) {
  if (listed.contract.default_k == 0) return "";
  return fmt::format("{} where neither k nor a radius is given", listed.contract.all_within.has_value()
                                                                     ? "all within the distance that it needs"
                                                                     : fmt::to_string(listed.contract.default_k));
}

std::vector<ListedOperator> listed_operators(const std::vector<std::string>& names) {
  std::vector<ListedOperator> operators;
  for (const std::string& name : names) {
    const bool is_knn = name == neighborhood_declaration().name;
    operators.push_back(is_knn ? listed_neighborhood() : listed(find_operator({name, {}, "operators"})));
  }
  if (!names.empty()) return operators;
  operators.push_back(listed_neighborhood());
  for (const OperatorDeclaration& declaration : all_operators()) operators.push_back(listed(declaration));
  return operators;
}

std::string command_of_operator(const std::string& name) {
  const bool is_knn = name == neighborhood_declaration().name;
  const OperatorDeclaration* const declaration = declaration_of(name);
  if (!is_knn && declaration == nullptr) return "";
  return fmt::format("pointsweep run IN... OUT --pipeline '{}'",
                     is_knn ? neighborhood_declaration().example : declaration->example);
}

std::string help_of_operator(const std::string& name) {
  const std::string command = command_of_operator(name);
  if (command.empty()) return "";
  return fmt::format("{}\nUsage: {}\n", to_text(listed_operators({name})), command);
}

std::string to_text(const std::vector<ListedOperator>& operators) {
  std::string text;
  for (const ListedOperator& listed_one : operators) text += operator_text(listed_one);
  return text;
}

std::string to_json(const std::vector<ListedOperator>& operators) {
  OrderedJson list = OrderedJson::array();
  for (const ListedOperator& listed : operators) list.push_back(json_of(listed));
  return list.dump(2) + "\n";
}

}  // namespace pointsweep
