// SPDX-License-Identifier: MIT
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/text/operator_listing.h"
#include "pointsweep/pipeline/plan/default_neighborhood.h"

namespace pointsweep {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kKindsOfOptions[] = {"whole",     "number",  "choice", "names", "point",      "attribute",
                                           "condition", "numbers", "file",   "word",  "attributes", "assignments"};
constexpr const char* kKindsOfAttributes[] = {"position", "vector", "normal", "scalar", "index", "color"};

OrderedJson json_of(const OptionValue& value) {
  if (const auto* whole = std::get_if<std::uint64_t>(&value)) return *whole;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* word = std::get_if<std::string>(&value)) return *word;
  if (const auto* point = std::get_if<Vec3>(&value)) return {point->x, point->y, point->z};
  return nullptr;
}

/// Returns the limit as a JSON number; null if there is no upper limit.
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
                    {"kind", kKindsOfAttributes[static_cast<std::size_t>(a.kind)]},
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

std::string to_json(const std::vector<ListedOperator>& operators) {
  OrderedJson list = OrderedJson::array();
  for (const ListedOperator& listed : operators) list.push_back(json_of(listed));
  return list.dump(2) + "\n";
}

}  // namespace pointsweep
