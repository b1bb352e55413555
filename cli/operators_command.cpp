// SPDX-License-Identifier: MIT
/// `pointsweep operators [NAME...]`: what a pipeline can be made of, as the declarations say.
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/help.h"
#include "pointsweep/error.h"
#include "pointsweep/pipeline/registry.h"

namespace pointsweep {
namespace {

constexpr std::size_t kMeaningColumn = 17;  // of names, before what they mean

void print_row(const std::string& name, const std::string& text) {
  fmt::print("  {:<{}}{}\n", name, kMeaningColumn - 2, wrapped(text, kMeaningColumn));
}

void print_options(const std::vector<OptionDeclaration>& options) {
  for (const OptionDeclaration& o : options) {
    const std::string preset = has_value(o.preset) ? fmt::format(" (default: {})", text_of_value(o.preset)) : "";
    print_row(o.name, fmt::format("{}: {}{}", o.allowed(), o.meaning, preset));
  }
}

/// "normal (nx ny nz float32), k1 (float32)"
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

void print_attributes(const char* what, const std::vector<Attribute>& attributes) {
  if (!attributes.empty()) print_row(what, attribute_text(attributes));
}

void print_title(const std::string& name, const std::string& meaning) {
  fmt::print("{}: {}\n", name, wrapped(meaning, name.size() + 2));
}

void print_example(const std::string& text) {
  if (!text.empty()) print_row("example", text);
}

void print_neighborhood() {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  print_title(knn.name, knn.meaning + "; the first stage of a pipeline, or left out");
  print_options(knn.options);
  print_example(knn.example);
}

void print_operator(const OperatorDeclaration& declaration) {
  print_title(declaration.name, declaration.meaning);
  print_options(declaration.options);
  const Contract contract = make_operator(declaration, sample_values(declaration), {})->contract();
  print_attributes("needs", contract.reads);
  print_attributes("of neighbours", contract.reads_neighbors);
  if (contract.selects == Selects::nothing) print_attributes("makes", contract.makes);
  print_example(declaration.example);
}

void print_operators(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (name == neighborhood_declaration().name)
      print_neighborhood();
    else
      print_operator(find_operator({name, {}, "operators"}));
  }
  if (!names.empty()) return;
  print_neighborhood();
  for (const OperatorDeclaration& declaration : all_operators()) print_operator(declaration);
}

}  // namespace

void add_operators_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("operators", "List the operators, their options, inputs and outputs");
  auto names = std::make_shared<std::vector<std::string>>();
  verb.add_option("NAME", *names, "Operators to list (default: all)")->type_name("");
  verb.footer(
      "'needs' and 'makes' are those of an operator without options. The examples are stages for 'pointsweep run'.\n"
      "\nExample:\n"
      "  pointsweep operators knn normals");
  verb.callback([names] { print_operators(*names); });
}

}  // namespace pointsweep
