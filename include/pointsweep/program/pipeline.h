// SPDX-License-Identifier: MIT
/// Pipelines stage by stage, for programs that make stages from flags or forms; parse_chain() is enough for others. The
/// first functions know only the syntax of pipelines, as text:
///   knn(k=8) | normals(orient=viewpoint, viewpoint=[0,0,1.7])
/// or as JSON, an array of stages, alone or like in PDAL under the key "pipeline":
///   [{"type": "knn", "k": 8}, {"type": "normals", "orient": "viewpoint", "viewpoint": [0, 0, 1.7]}]
/// The other functions find operators by name and build the chain of a pipeline.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/cloud.h"
#include "pointsweep/export.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {

/// The text of one option. A list is stored as its elements separated by commas, as "0,0,1.7". The name is empty if
/// only a value is given, as in where("z < 2").
struct OptionText {
  std::string name, value;
  std::string place;  ///< for messages, e.g. "pipeline, column 12" or "chain.json, stage 2"

  friend bool operator==(const OptionText& a, const OptionText& b) { return a.name == b.name && a.value == b.value; }
};

struct StageText {
  std::string name;
  std::vector<OptionText> options;
  std::string place;

  friend bool operator==(const StageText& a, const StageText& b) { return a.name == b.name && a.options == b.options; }
};

/// Parses either form: a text that begins with [ or { is JSON. Values with characters other than letters, digits and _
/// . + - % : / need quotes, single or double, with \ before a quote or a \. Throws UsageError with the place, in which
/// `source` is the name of the text.
POINTSWEEP_EXPORT std::vector<StageText> parse_pipeline(std::string_view text, std::string_view source = "pipeline");

/// Parses JSON only. Accepts pipelines of PDAL if all their stages exist in pointsweep, too.
POINTSWEEP_EXPORT std::vector<StageText> parse_json_pipeline(std::string_view text, std::string_view source);

/// Parses the content of a file if the name ends with .json, otherwise the text itself.
POINTSWEEP_EXPORT std::vector<StageText> parse_pipeline_or_file(const std::string& text_or_file);

/// Returns the stages as text, not JSON; parse_pipeline() restores the stages.
POINTSWEEP_EXPORT std::string to_text(const std::vector<StageText>& stages);

/// Returns whether `name` may be the name of an operator or an option: letters, digits, _ . and -.
POINTSWEEP_EXPORT bool is_name(std::string_view name);

/// Returns the operators of pipelines, in the order of their presentation.
POINTSWEEP_EXPORT const std::vector<OperatorDeclaration>& all_operators();
/// Returns the declaration of an operator; null if no operator has this name.
POINTSWEEP_EXPORT const OperatorDeclaration* declaration_of(std::string_view name);
/// Returns the declaration of the operator of `stage`. If it is unknown, throws UsageError with the most similar known
/// names.
POINTSWEEP_EXPORT const OperatorDeclaration& find_operator(const StageText& stage);
/// Returns the declaration of the graph of neighbours (operators::neighbors). It is no stage of pipelines, since it
/// needs the k of the neighbourhoods.
POINTSWEEP_EXPORT OperatorDeclaration neighbors_declaration();
/// Returns advice for a word of other programs, e.g. "reproject" or "merge"; empty for all other words.
POINTSWEEP_EXPORT std::string_view advice_for(std::string_view word);

/// Returns the value of `text`; nothing if `text` has not the form of the option's kind or the value is not allowed.
POINTSWEEP_EXPORT std::optional<OptionValue> parse_value(const OptionDeclaration& option, std::string_view text);
/// Returns the values of a stage's options. Throws UsageError for an option that is not declared, given twice or
/// missing, and for a value that is not allowed.
POINTSWEEP_EXPORT OptionValues read_options(const std::vector<OptionDeclaration>& declared, const StageText& stage);

/// Returns the chain of a pipeline. Throws UsageError with the place for an unknown name, a value out of range, and a
/// knn that is not the first stage. If knn states neither k nor a radius, the neighbourhood is
/// Neighborhood::kOfOperators.
POINTSWEEP_EXPORT Chain build_chain(const std::vector<StageText>& stages, Facts facts);
/// Returns the chain of a pipeline for `cloud`, with the errors of the function above. Only run() checks the chain
/// against the attributes of the cloud. `keep` (Chain::keep) may name made attributes with the `prefix` that they have
/// in the output (RunOptions::prefix), or without.
POINTSWEEP_EXPORT Chain build_chain(const std::vector<StageText>& stages, const Cloud& cloud,
                                    const std::vector<std::string>& keep = {}, const std::string& prefix = "");
/// Throws UsageError if the chain has no stages. The chain of the pipeline `knn(k=8)` has none.
POINTSWEEP_EXPORT void require_operators(const Chain& chain);

enum class Presets : bool {
  left_out,     ///< omitted, for messages: "normals"
  spelled_out,  ///< written out, independent of the presets of other versions: "normals(orient=none)"
};

/// Returns the neighbourhood and the stages as canonical texts, such as "normals(orient=up)": the name, and the options
/// in the order of their declaration, with numbers in their shortest form. Equal stages have equal texts, whether made
/// from text, from JSON or by a program. parse_pipeline() reads the texts if all operators are registered. A default
/// neighbourhood is written out, unless the chain has no stages.
POINTSWEEP_EXPORT std::vector<std::string> canonical_stages(const Chain& chain, Presets presets);

}  // namespace pointsweep
