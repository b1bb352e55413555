// SPDX-License-Identifier: MIT
/// Every spelling of an attribute is understood wherever a chain names an attribute, for all spellings, operators and
/// options of the tables.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <functional>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

Schema schema_with(const std::string& field) {
  Schema schema;
  for (const char* axis : {"x", "y", "z"}) schema.append(axis, Type::f64);
  schema.append(field, Type::u16);
  return schema;
}

/// Calls look(field, word) for all pairs of a spelling in files and a spelling of users that mean one attribute.
/// Conditions and assignments have no words with blanks.
void for_each_pair_of_spellings(const std::function<void(const std::string& field, const std::string& word)>& look) {
  for (const std::string& name : names_with_spellings()) {
    std::vector<std::string> fields = spellings_of(name);
    const std::vector<std::string> words = words_for(name);
    for (std::string& field : fields) field[0] = static_cast<char>(std::toupper(field[0]));
    for (const std::string& field : fields)
      for (const std::string& word : words)
        if (word.find(' ') == word.npos) look(field, word);
  }
}

/// Returns whether some stage reads the field `field` of the input, writes a new version of it, or drops it.
bool concerns(const ChainPlan& plan, const std::string& field) {
  return !plan.graph.dropped.empty() || std::ranges::any_of(plan.graph.versions, [&](const AttributeVersion& version) {
    const Schema input = schema_with(field);
    const std::vector<std::string>& names = version.attribute.fields;
    return names.size() == 1 && field_meant(input, names[0]) == 3u && (!version.producer || names[0] == field);
  });
}

bool names_attributes(const OptionDeclaration& option) {
  return option.kind == OptionKind::attribute || option.kind == OptionKind::attributes ||
         option.kind == OptionKind::condition || option.kind == OptionKind::assignments;
}

/// Returns a value of the option that names `word`. The option `of` names results of the operator statistics.
std::string value_with(const OptionDeclaration& option, const std::string& word) {
  const OptionKind kind = option.kind;
  if (option.name == "of") return word + "_mean";
  if (kind == OptionKind::condition) return word + " == 1";
  return kind == OptionKind::assignments ? word + " = 1" : word;
}

/// Returns a stage in which `option` names `word`, with the other options that it requires.
StageText stage_with(const OperatorDeclaration& declaration, const OptionDeclaration& option, const std::string& word) {
  StageText stage{declaration.name, {{option.name, value_with(option, word), "here"}}, "here"};
  for (const OptionDeclaration& other : declaration.options)
    if (other.name != option.name && (other.required || other.name == "k"))
      stage.options.push_back({other.name, other.name == "k" ? "64" : text_of_value(other.sample), "here"});
  return stage;
}

TEST(Spellings, AreUnderstoodByEveryOptionOfEveryOperatorThatNamesAttributes) {
  std::size_t options = 0;
  for (const OperatorDeclaration& declaration : all_operators())
    for (const OptionDeclaration& option : declaration.options) {
      const bool of_another_cloud = declaration.options.front().kind == OptionKind::file;
      if (!names_attributes(option) || of_another_cloud) continue;
      ++options;
      for_each_pair_of_spellings([&](const std::string& field, const std::string& word) {
        try {
          const std::vector<StageText> stages = {stage_with(declaration, option, word), {"density", {}, "here"}};
          EXPECT_TRUE(concerns(plan_chain(build_chain(stages, Facts{}), schema_with(field)), field))
              << declaration.name << " " << option.name << ": " << word << " of " << field;
        } catch (const Error& error) {
          ADD_FAILURE() << declaration.name << " " << option.name << ": " << word << " of " << field << "\n"
                        << error.what();
        }
      });
    }
  EXPECT_GE(options, 5u);
}

TEST(Spellings, AreUnderstoodByEveryOptionOfNeighborhoodsAndByKeep) {
  for (const OptionDeclaration& option : neighborhood_declaration().options) {
    if (!names_attributes(option)) continue;
    for_each_pair_of_spellings([&](const std::string& field, const std::string& word) {
      const std::string text = fmt::format("knn(k=8, {}={}) | normals", option.name, word);
      EXPECT_TRUE(concerns(plan_chain(build_chain(parse_pipeline(text), Facts{}), schema_with(field)), field))
          << text << " of " << field;
    });
  }
  for_each_pair_of_spellings([&](const std::string& field, const std::string& word) {
    Chain chain = build_chain(parse_pipeline("density"), Facts{});
    chain.keep = {"surface_density", word};
    const ChainPlan plan = plan_chain(chain, schema_with(field));
    EXPECT_FALSE(plan.kept.input) << word << " is the only attribute that " << field << " can be";
  });
}

/// A made attribute is meant by all spellings of its name, even if the input has an attribute with one of them.
TEST(Spellings, MeanWhatIsMadeRatherThanWhatTheInputHas) {
  for (const char* field : {"NormalZ", "nz", "intensity"})
    for (const char* word : {"nz", "NormalZ", "normal_z"}) {
      const std::string text = fmt::format("normals | where({} > 0)", word);
      const ChainPlan plan = plan_chain(build_chain(parse_pipeline(text), Facts{}), schema_with(field));
      EXPECT_TRUE(std::ranges::all_of(plan.graph.versions, [](const auto& v) { return v.producer.has_value(); }))
          << text << " of " << field;
    }
  // Programs use "curvature" for different quantities. Here it means the attribute of the input, which has exactly this
  // name.
  const Chain chain = build_chain(parse_pipeline("normals | curvature | where(curvature > 0)"), Facts{});
  const ChainPlan plan = plan_chain(chain, schema_with("curvature"));
  EXPECT_TRUE(std::ranges::any_of(plan.graph.versions, [](const auto& v) { return !v.producer; }));
}

/// A column that comes from another program is not taken for a field of LAS, unless its spelling says so.
TEST(Spellings, WordsOfUsersAreNoSpellingsOfFiles) {
  for (const char* word : {"KeyPoint", "ScanDirectionFlag", "Infrared", "Overlap_flag"}) {
    Schema schema = schema_with(word);
    EXPECT_FALSE(schema.find("key_point") || schema.find("scan_direction_flag") || schema.find("nir")) << word;
    schema.append("key_point", Type::u8);
    EXPECT_EQ(field_meant(schema, word), 3u) << word;
  }
  EXPECT_EQ(field_meant(schema_with("key_point"), "Keypoint_flag"), 3u);
}

TEST(Spellings, OfANewAttributeGetTheTypeThatLasHasForIt) {
  const Chain chain = build_chain(parse_pipeline("set(ReturnNumber = 1)"), Facts{});
  const ChainPlan plan = plan_chain(chain, schema_with("intensity"));
  EXPECT_EQ(plan.made.at(0).type, Type::u8);
  EXPECT_EQ(plan.made.at(0).name, "ReturnNumber");
}

}  // namespace
}  // namespace pointsweep
