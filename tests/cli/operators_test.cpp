// SPDX-License-Identifier: MIT
/// The texts of the tool and of the docs about operators agree with the declarations of the operators.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/text/operator_listing.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/program/pipeline.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using OperatorListing = Tool;

std::string document(const std::string& name) {
  return contents(std::filesystem::path(POINTSWEEP_SOURCE_DIR) / "docs" / name);
}

TEST_F(OperatorListing, DocsAreWhatTheToolPrints) {
  EXPECT_EQ(tool("operators --markdown").out, document("operators.md")) << "run script/docs";
  const std::string page = document("attributes.md"), begin = "<!-- attributes:", end = "<!-- end of attributes -->";
  const std::size_t from = page.find('\n', page.find(begin)) + 1;
  EXPECT_EQ(tool("operators --attributes").out, page.substr(from, page.find(end) - from)) << "run script/docs";
}

/// Returns the text between `begin` and `end`; empty if `begin` is missing.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  return from == text.npos ? "" : text.substr(from, text.find(end, from + begin.size()) - from);
}

/// Returns the words up to `after`, from all lines that begin with `before`.
std::vector<std::string> words_of_lines(const std::string& text, const std::string& before, char after) {
  std::vector<std::string> words;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(before)) words.push_back(between(line.substr(before.size()), "", std::string(1, after)));
  return words;
}

TEST_F(OperatorListing, JsonPythonAndDocsHaveTheOptionsOfTheRegistry) {
  const auto json = nlohmann::json::parse(tool("operators --json").out);
  const std::string python = contents(std::filesystem::path(POINTSWEEP_SOURCE_DIR) / "python/pointsweep/_stages.py");
  const std::string docs = document("operators.md");
  for (std::size_t i = 0; i < all_operators().size(); ++i) {
    const OperatorDeclaration& declaration = all_operators()[i];
    std::vector<std::string> names, in_json;
    for (const OptionDeclaration& option : declaration.options) names.push_back(option.name);
    for (const auto& option : json[i + 1]["options"]) in_json.push_back(option["name"]);
    EXPECT_EQ(in_json, names) << declaration.name;
    const std::string stage = between(python, "made_stage(\"" + declaration.name + "\", [", "\n\n");
    const std::string section = between(docs, "\n## " + declaration.name + "\n", "\n## ");
    EXPECT_NE(stage, "") << declaration.name << ": run script/docs";
    EXPECT_NE(section, "") << declaration.name << ": run script/docs";
    EXPECT_EQ(words_of_lines(stage, "        (\"", '"'), names) << declaration.name << ": run script/docs";
    EXPECT_EQ(words_of_lines(between(section, "", "| makes |"), "| `", '`'), names)
        << declaration.name << ": run script/docs";
  }
}

TEST_F(OperatorListing, JsonHoldsEveryOptionWithTypeDefaultAndRange) {
  const auto listed = nlohmann::json::parse(tool("operators --json").out);
  ASSERT_EQ(listed.size(), 1 + all_operators().size());
  EXPECT_EQ(listed[0]["name"], "knn");
  EXPECT_EQ(listed[0]["options"][0]["default"], nullptr) << "it is that of the operators";
  EXPECT_EQ(listed[0]["options"][0]["range"], nlohmann::json({1, nullptr}));
  EXPECT_EQ(listed[0]["options"][0]["allowed"], "1 or more");
  for (std::size_t i = 0; i < all_operators().size(); ++i) {
    const OperatorDeclaration& declaration = all_operators()[i];
    const auto& json = listed[i + 1];
    EXPECT_EQ(json["name"], declaration.name);
    const Contract contract = contract_of(declaration);
    EXPECT_EQ(json["default_k"], contract.default_k) << declaration.name;
  }
  const auto fair = nlohmann::json::parse(tool("operators fair --json").out).at(0);
  EXPECT_EQ(fair["options"][0]["default"], 0.5);
  EXPECT_EQ(fair["options"][0]["unit"], "% of the diagonal");
  EXPECT_EQ(fair["makes"][0]["fields"], nlohmann::json({"x", "y", "z"}));
  refused(2, "operators --json --markdown", "--markdown");
}

TEST_F(OperatorListing, EveryMadeAttributeIsDescribedOnce) {
  std::vector<OperatorDeclaration> declarations = all_operators();
  declarations.push_back(neighbor_rows_declaration());
  for (const OperatorDeclaration& declaration : declarations) {
    std::set<std::string> made, described;
    for (const Attribute& a : contract_of(declaration).makes) made.insert(a.name);
    for (const AttributeNote& note : declaration.attributes) EXPECT_TRUE(described.insert(note.name).second);
    for (const std::string& name : described) EXPECT_TRUE(made.contains(name)) << declaration.name << ": " << name;
  }
}

TEST_F(OperatorListing, FlagsOfVerbsAreTheOptionsOfTheirOperators) {
  for (const auto& [verb, names] : {std::pair<std::string, std::vector<std::string>>{"normals", {"normals"}},
                                    {"curvature", {"normals", "curvature"}},
                                    {"splats", {"normals", "splats"}},
                                    {"features", {"features"}},
                                    {"fair", {"normals", "fair"}},
                                    {"neighbors", {}},
                                    {"run", {"normals"}}}) {
    const std::string help = tool("help " + verb).out;
    const auto expect_flag = [&, &verb = verb](const OptionDeclaration& option) {
      std::string flag = option.name == "k" ? "-k" : "--" + option.name;
      std::ranges::replace(flag, '_', '-');
      EXPECT_NE(help.find("\n  " + flag + " "), std::string::npos) << verb << " " << flag;
    };
    for (const std::string& name : names)
      for (const OptionDeclaration& option : declaration_of(name)->options) expect_flag(option);
    if (verb == "run") continue;
    for (const OptionDeclaration& option : neighborhood_declaration().options) expect_flag(option);
  }
}

}  // namespace
}  // namespace pointsweep
