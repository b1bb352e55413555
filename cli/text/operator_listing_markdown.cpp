// SPDX-License-Identifier: MIT
/// Declarations of operators as pages of docs/.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "cli/text/help.h"
#include "cli/text/operator_listing.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

/// Returns the type as the docs write it: "f32", "u8".
std::string short_type(Type type) {
  const std::string_view name = name_of(type);
  return name[0] + std::string(name.substr(name.find_first_of("123468")));
}

/// Escapes bars, which would end the cell of a table.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != text.npos; at += 2) text.insert(at, "\\");
  return text;
}

/// Returns a unit such as "1/length^2" with raised digits instead of ^2 and ^3.
std::string unit_text(std::string unit) {
  for (const auto& [power, digit] : {std::pair("^2", "²"), std::pair("^3", "³")})
    if (const std::size_t at = unit.find(power); at != unit.npos) unit.replace(at, 2, digit);
  return unit;
}

std::string table_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& c : cells) row += c.empty() ? " |" : fmt::format(" {} |", cell(c));
  return row + "\n";
}

std::string table_head(const std::vector<std::string>& titles) {
  std::string rule = "|";
  for (std::size_t i = 0; i < titles.size(); ++i) rule += "---|";
  return table_row(titles) + rule + "\n";
}

std::string sentence(const std::string& text) { return capitalized(text) + (text.ends_with('.') ? "" : "."); }

std::string options_table(const std::vector<OptionDeclaration>& options) {
  if (options.empty()) return "No options.\n\n";
  std::string table = table_head({"option", "value", "default", "unit", "meaning"});
  for (const OptionDeclaration& o : options) {
    const std::string preset = has_value(o.preset) ? fmt::format("`{}`", text_of_value(o.preset)) : "";
    table += table_row({fmt::format("`{}`", o.name), o.allowed(), o.required ? "required" : preset, o.unit, o.meaning});
  }
  return table + "\n";
}

const AttributeNote* note_on(const OperatorDeclaration& declaration, const Attribute& attribute) {
  const auto found = std::ranges::find(declaration.attributes, attribute.name, &AttributeNote::name);
  return found == declaration.attributes.end() ? nullptr : &*found;
}

std::string meaning_of(const OperatorDeclaration& declaration, const Attribute& attribute) {
  const AttributeNote* note = note_on(declaration, attribute);
  return note != nullptr ? note->meaning : attribute.meaning;
}

std::string made_table(const ListedOperator& listed) {
  if (listed.contract.makes.empty()) return "";
  std::string table = table_head({"makes", "type", "unit", "meaning"});
  for (const Attribute& a : listed.contract.makes) {
    const AttributeNote* note = note_on(listed.declaration, a);
    const std::string components = a.fields.size() > 1 ? fmt::format("{} × ", a.fields.size()) : "";
    const std::string type = note != nullptr && !note->type.empty() ? note->type : short_type(a.type);
    table += table_row(
        {fmt::format("`{}`", a.name), components + type, unit_text(a.unit), meaning_of(listed.declaration, a)});
  }
  return table + "\n";
}

std::string needs_text(const Contract& contract) {
  const auto names = [](const std::vector<Attribute>& attributes) {
    std::string text;
    for (const Attribute& a : attributes) text += fmt::format("{}`{}`", text.empty() ? "" : ", ", a.name);
    return text;
  };
  std::string text;
  if (!contract.reads.empty()) text += fmt::format("Needs of the point: {}.", names(contract.reads));
  if (!contract.reads_neighbors.empty())
    text += fmt::format("{}Needs of its neighbours: {}.", text.empty() ? "" : " ", names(contract.reads_neighbors));
  return text.empty() ? "" : text + "\n\n";
}

/// Returns "`knn` `radius`, `radius_from`; `ror` `radius`": all options that mean a radius.
std::string radii_text(const std::vector<ListedOperator>& operators) {
  std::string text;
  for (const ListedOperator& listed : operators) {
    std::string names;
    for (const OptionDeclaration& option : listed.declaration.options)
      if (option.is_radius) names += fmt::format("{}`{}`", names.empty() ? "" : ", ", option.name);
    if (!names.empty()) text += fmt::format("{}`{}` {}", text.empty() ? "" : "; ", listed.declaration.name, names);
  }
  return text;
}

std::string line_unless_empty(const char* title, const std::string& text) {
  return text.empty() ? "" : fmt::format("- {}: {}\n", title, sentence(text));
}

/// Returns the formula as a code block. Long lines are broken, since browsers do not wrap the lines of a code block.
std::string formula_block(const std::string& formula) {
  if (formula.empty()) return "";
  std::istringstream lines(formula);
  std::string text = "```text\n";
  for (std::string line; std::getline(lines, line);) text += wrapped(line, 2, 120) + "\n";
  return text + "```\n";
}

std::string section(const ListedOperator& listed) {
  const OperatorDeclaration& d = listed.declaration;
  std::string text = fmt::format("## {}\n{}\n\n", d.name, sentence(d.meaning)) + options_table(d.options);
  text += needs_text(listed.contract) + made_table(listed);
  text += formula_block(d.formula);
  text += line_unless_empty("Neighbours", default_k_text(listed));
  text += line_unless_empty("Source", d.source) + line_unless_empty("Undefined", d.undefined);
  text += line_unless_empty("Cost", d.cost);
  return text + (d.example.empty() ? "" : fmt::format("- Example: `{}`\n", d.example)) + "\n";
}

/// Returns the fields of an attribute; "same" if its only field has the name of the attribute.
std::string fields_text(const Attribute& attribute) {
  if (!attribute.is_list()) return "same";
  std::string text;
  for (const std::string& field : attribute.fields) text += (text.empty() ? "" : " ") + field;
  return fmt::format("`{}`", text);
}

std::string attribute_row(const OperatorDeclaration& declaration, const Attribute& a, const std::string& made_by) {
  const AttributeNote* note = note_on(declaration, a);
  const bool own_type = note != nullptr && !note->type.empty(), own_shape = note != nullptr && !note->shape.empty();
  const std::string shape = a.fields.size() > 1 ? fmt::format("N×{}", a.fields.size()) : "N";
  return table_row({fmt::format("`{}`", a.name), own_type ? note->type : short_type(a.type),
                    own_shape ? note->shape : shape, own_shape ? fmt::format("`{}` ...", a.fields[0]) : fields_text(a),
                    unit_text(a.unit), kind_text(a), made_by, meaning_of(declaration, a)});
}

std::string attribute_rows(const OperatorDeclaration& declaration) {
  std::string rows;
  for (const Attribute& a : contract_of(declaration).makes) {
    const bool in_files = a.name == normal_attribute().name;
    rows += attribute_row(declaration, a, declaration.name + (in_files ? ", input" : ""));
  }
  return rows;
}

}  // namespace

std::string to_markdown(const std::vector<ListedOperator>& operators) {
  std::string text =
      "# Operators\n"
      "<!-- Made by script/docs from the declarations in pointsweep/operators/. -->\n\n"
      "The stages of pipelines, as `pointsweep operators` lists them. A pipeline is text, `knn(k=12) | "
      "normals(orient=up)`, or JSON,\n"
      "`[{\"type\": \"knn\", \"k\": 12}, {\"type\": \"normals\", \"orient\": \"up\"}]`. Verbs take the same options as "
      "flags: `-k 12 --orient up`.\n"
      "Needs and attributes are those of an operator without options. `docs/attributes.md` describes the "
      "attributes.\n\n";
  text +=
      "A point counts within a radius R if `d² <= R·R`, d² = ((dx² + dy²) + dz²), all in float64; a point at "
      "exactly "
      "R counts. This rule holds for\n" +
      radii_text(operators) +
      ".\n"
      "A square root that was rounded down, such as `neighbor_radius`, can therefore be too small for the "
      "neighbour "
      "whose distance it is.\n\n"
      "Points with NaN or infinite coordinates are neighbours of no point. A stage that looks at its own point "
      "alone (`where`, `crop`, `set`, `color`,\n"
      "`orient` by a trajectory) treats them as any other. Every other stage leaves them unchanged: they are not "
      "moved, an attribute that the\n"
      "stage reads and makes again keeps its value, and all else that it makes gets the value that is documented "
      "for undefined results.\n\n";
  for (const ListedOperator& listed : operators) text += section(listed);
  text.pop_back();
  return text;
}

std::string attributes_markdown() {
  std::string text =
      table_head({"attribute", "type", "shape", "fields in files", "unit", "kind", "made by", "meaning"});
  text += attribute_rows(neighbors_declaration());
  for (const OperatorDeclaration& declaration : all_operators()) text += attribute_rows(declaration);
  return text;
}

}  // namespace pointsweep
