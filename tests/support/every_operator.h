// SPDX-License-Identifier: MIT
/// Pipelines for laws that hold for every operator of the registry.
#pragma once

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {

/// A stage of the registry and a pipeline that runs it.
struct OperatorCase {
  const OperatorDeclaration* declaration;
  std::string stage;     ///< canonical text
  std::string pipeline;  ///< neighbourhood, stages that make the needed attributes, and the stage
};

/// Makes cases for clouds with the attributes `of_input`. `neighborhood`: the first stage, "knn(radius=4)".
/// `other_cloud`: the file of the other cloud that operators read.
class EveryOperator {
 public:
  EveryOperator(std::set<std::string> of_input, std::string neighborhood, std::string other_cloud)
      : of_input_(std::move(of_input)), neighborhood_(std::move(neighborhood)), other_cloud_(std::move(other_cloud)) {}

  /// Returns one case for each operator, one for each further word of a choice, and one for each further option that
  /// needs no other option.
  std::vector<OperatorCase> cases() const {
    std::vector<OperatorCase> all;
    for (const OperatorDeclaration& declaration : all_operators()) {
      add_case(declaration, values_of(declaration), all);
      for (const OptionDeclaration& option : declaration.options)
        for (const OptionValue& other : others_than_preset(option)) {
          OptionValues values = values_of(declaration);
          if (values.give(option.name, other)) add_case(declaration, values, all);
        }
    }
    return all;
  }

  /// Returns the case of a stage with these values.
  OperatorCase case_of(const OperatorDeclaration& declaration, const OptionValues& values) const {
    const auto stage = declaration.make(values, {});
    const std::string text = canonical_text(stage, Presets::left_out);
    if (operator_of(stage) == nullptr && !std::holds_alternative<Drop>(stage))
      return {&declaration, text, neighborhood_ + " | set(z = z + 1) | " + text + " | neighborhood_size"};
    std::set<std::string> known = of_input_;
    return {&declaration, text, neighborhood_ + makers_of(stage, known) + " | " + text};
  }

  /// Returns samples of the options that are required, or whose names may be left out.
  OptionValues values_of(const OperatorDeclaration& declaration) const {
    OptionValues values(declaration.options, declaration.name);
    for (const OptionDeclaration& option : declaration.options)
      if ((option.required || option.positional) && has_value(option.sample))
        values.give(option.name, option.kind == OptionKind::file ? OptionValue(other_cloud_) : option.sample);
    return values;
  }

 private:
  static std::vector<OptionValue> others_than_preset(const OptionDeclaration& option) {
    std::vector<OptionValue> others;
    if (option.kind == OptionKind::choice)
      for (const std::string& choice : option.choices)
        if (OptionValue(choice) != option.preset) others.emplace_back(choice);
    if (option.kind == OptionKind::number && has_value(option.sample)) others.push_back(option.sample);
    return others;
  }

  /// Adds a case, unless the values need further options.
  void add_case(const OperatorDeclaration& declaration, const OptionValues& values,
                std::vector<OperatorCase>& all) const {
    try {
      all.push_back(case_of(declaration, values));
    } catch (const UsageError&) {
    }
  }

  /// Returns text such as " | normals | splats": the stages of the registry that make the attributes that `needy`
  /// reads.
  std::string makers_of(const ChainStage& needy, std::set<std::string>& known) const {
    std::string text;
    const Contract contract = contract_of(needy);
    for (const auto* needs : {&contract.reads, &contract.reads_neighbors})
      for (const Attribute& need : *needs) {
        if (known.contains(need.name)) continue;
        for (const OperatorDeclaration& maker : all_operators()) {
          const auto stage = maker.make(values_of(maker), {});
          const std::vector<Attribute> made = contract_of(stage).makes;
          if (std::ranges::find(made, need.name, &Attribute::name) == made.end()) continue;
          text += makers_of(stage, known) + " | " + canonical_text(stage, Presets::left_out);
          for (const Attribute& a : made) known.insert(a.name);
          break;
        }
      }
    return text;
  }

  std::set<std::string> of_input_;
  std::string neighborhood_, other_cloud_;
};

}  // namespace pointsweep
