// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/pipeline.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/fixed_seed.h"

namespace pointsweep {
namespace {

using StageTexts = std::vector<StageText>;

std::string told(const std::string& text) {
  return refusal([&] { parse_pipeline(text); });
}

/// Expects that the sentence of the refusal has the place and the words.
void expect_told(const std::string& text, const std::string& place, const std::string& words) {
  const std::string sentence = told(text);
  EXPECT_NE(sentence.find(place), std::string::npos) << text << "\n" << sentence;
  EXPECT_NE(sentence.find(words), std::string::npos) << text << "\n" << sentence;
}

const StageTexts kExample = {{"knn", {{"k", "8", ""}}, ""},
                             {"normals", {{"orient", "viewpoint", ""}, {"viewpoint", "0,-1.5,1e3", ""}}, ""},
                             {"splats", {}, ""}};

TEST(Parse, StagesOptionsAndLists) {
  EXPECT_EQ(parse_pipeline("knn(k=8) | normals(orient=viewpoint, viewpoint=[0,-1.5,1e3]) | splats"), kExample);
}

TEST(Parse, SpaceMeansNothingBetweenWords) {
  EXPECT_EQ(parse_pipeline("\n knn ( k\t=  8 )|normals(orient=viewpoint,viewpoint=[ 0 , -1.5 ,1e3 ] )\r\n| splats() "),
            kExample);
}

TEST(Parse, ConditionsEndWhereTheirParenthesesClose) {
  for (const char* condition :
       {"a in (2, 9)", "not a in(2, 9)", "abs(a) in (min(1, 2), 3)", "a not in (2, 9) and b > 1", "a between 2 and 5",
        "a between min(1, 2) and 5", "`a, (b` > 1 && `c|d` < `e)`", "`a b`"}) {
    const StageTexts stages = parse_pipeline("where(" + std::string(condition) + ", x=1) | b");
    ASSERT_EQ(stages.size(), 2u) << condition;
    EXPECT_EQ(stages[0].options, (std::vector<OptionText>{{"", condition, ""}, {"x", "1", ""}}));
  }
  for (const char* condition : {"z > 1", "a in (2, 9)", "a BETWEEN 2 AND 5", "class == 2 && min(a, b) != 3"}) {
    const std::string text = fmt::format("statistics(count, where={}, most = 3)", condition);
    EXPECT_EQ(parse_pipeline(text)[0].options,
              (std::vector<OptionText>{{"", "count", ""}, {"where", condition, ""}, {"most", "3", ""}}));
  }
  for (const char* text : {"where(in=2)", "where(between=in)", "where(a = in, between)"})
    EXPECT_EQ(parse_pipeline(text)[0].options.back().value.find('='), std::string::npos) << text;
}

TEST(Parse, QuotesHoldAnyCharacter) {
  const StageTexts stages = parse_pipeline(R"(a(x="p | q) \"\\", y='it\'s', z=""))");
  ASSERT_EQ(stages.size(), 1u);
  EXPECT_EQ(stages[0].options, (std::vector<OptionText>{{"x", "p | q) \"\\", ""}, {"y", "it's", ""}, {"z", "", ""}}));
}

TEST(Parse, JsonArraySaysTheSame) {
  EXPECT_EQ(parse_pipeline(R"([{"type": "knn", "k": 8},
                               {"type": "normals", "orient": "viewpoint", "viewpoint": [0, -1.5, "1e3"]},
                               {"type": "splats"}])"),
            kExample);
}

TEST(Parse, PdalPipelineObjectSaysTheSame) {
  EXPECT_EQ(parse_pipeline(R"( {"pipeline": [{"type": "knn", "k": 8}]})"), parse_pipeline("knn(k=8)"));
}

TEST(Parse, JsonNumbersKeepTheirValue) {
  const StageTexts stages =
      parse_pipeline(R"([{"type": "a", "b": 0.1, "c": 1e300, "d": 18446744073709551615, "e": -3, "f": true}])");
  const auto& o = stages[0].options;
  ASSERT_EQ(o.size(), 5u);
  EXPECT_EQ(o[0].value, "0.1");
  EXPECT_EQ(std::stod(o[1].value), 1e300);
  EXPECT_EQ(o[2].value, "18446744073709551615");
  EXPECT_EQ(o[3].value, "-3");
  EXPECT_EQ(o[4].value, "true");
}

TEST(Parse, AJsonFileIsReadAndNamedInMessages) {
  const auto path = std::filesystem::temp_directory_path() / "pointsweep-parse-test.json";
  std::ofstream(path) << R"([{"type": "knn", "k": 8}, 7])";
  const std::string sentence = refusal([&] { parse_pipeline_or_file(path.string()); });
  EXPECT_NE(sentence.find(path.string() + ", stage 2"), std::string::npos) << sentence;
  std::ofstream(path) << R"([{"type": "knn", "k": 8}])";
  EXPECT_EQ(parse_pipeline_or_file(path.string()), parse_pipeline("knn(k=8)"));
  std::ofstream(path) << "\xEF\xBB\xBF"
                      << R"([{"type": "knn", "k": 8}])";
  EXPECT_EQ(parse_pipeline_or_file(path.string()), parse_pipeline("knn(k=8)"))
      << "an editor began it with a byte order mark";
  std::filesystem::remove(path);
  EXPECT_THROW(parse_pipeline_or_file(path.string()), Error);
}

TEST(Parse, MessagesNameTheColumn) {
  expect_told("", "pipeline", "is empty");
  expect_told("  \n", "pipeline", "is empty");
  expect_told("| normals", "column 1:", "name of an operator");
  expect_told("knn(k=8) |", "column 11:", "the text ends");
  expect_told("knn(k=8) normals", "column 10:", "'|' or the end is expected, not 'n'");
  expect_told("knn(8 9)", "column 7:", "',' or ')' is expected");
  expect_told("knn(k=)", "column 7:", "a value is expected");
  expect_told("knn(k=8", "column 8:", "the text ends");
  expect_told("knn(k=8,)", "column 9:", "name of an option");
  expect_told("a(b=[1,])", "column 8:", "a value is expected");
  expect_told("a(b=[1)", "column 7:", "',' or ']' is expected");
  expect_told("a(b='c)", "column 5:", "quote");
}

TEST(Parse, MessagesAboutJsonNameTheLineOrTheStage) {
  expect_told("[{\"type\": \"knn\"},\n {\"type\" 3}]", "line 2, column 10:", "is not JSON");
  expect_told("[", "line 1, column 2:", "is not JSON");
  expect_told("[]", "pipeline:", "not an array of stages");
  expect_told("{\"stages\": []}", "pipeline:", "\"pipeline\"");
  expect_told("{\"pipeline\": {}}", "pipeline:", "not an array of stages");
  expect_told(R"([{"type": "knn"}, "out.las"])", "stage 2:", "files are named on the command line");
  expect_told(R"([{"k": 3}])", "stage 1:", "has no \"type\"");
  expect_told(R"([{"type": "a b"}])", "stage 1:", "has no \"type\"");
  expect_told(R"([{"type": "knn", "k": null}])", "stage 1:", "'k' is not a number");
  expect_told(R"([{"type": "knn", "k": [[1]]}])", "stage 1:", "'k' is not a number");
  expect_told(R"([{"type": "knn", "a(b": 1}])", "stage 1:", "not the name of an option");
  expect_told(R"([{"type": "knn", "k": 1, "k": 2}])", "pipeline:", "'k' is given twice");
  expect_told(R"([{"type": "knn", "k": 1e999}])", "pipeline", "number");
}

TEST(Parse, PlacesAreThoseOfTheWords) {
  const StageTexts stages = parse_pipeline("knn(k=8) | normals(orient = up)");
  EXPECT_EQ(stages[1].place, "pipeline, column 12");
  EXPECT_EQ(stages[1].options[0].place, "pipeline, column 20");
}

rc::Gen<std::string> names() {
  return rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::elementOf(std::string("abcXYZ019_.-"))));
}

rc::Gen<std::string> values() {
  return rc::gen::oneOf(rc::gen::container<std::string>(rc::gen::elementOf(std::string("ab1,|()[]='\"\\ \n%+-./:{}"))),
                        rc::gen::arbitrary<std::string>());
}

/// Generates up to 20 stages of up to 20 options. With the default of up to 100 elements, texts would have megabytes.
rc::Gen<StageTexts> pipelines() {
  const auto option = rc::gen::construct<OptionText>(names(), values(), rc::gen::just(std::string()));
  const auto stage = rc::gen::construct<StageText>(names(), rc::gen::container<std::vector<OptionText>>(option),
                                                   rc::gen::just(std::string()));
  return rc::gen::scale(0.2, rc::gen::nonEmpty(rc::gen::container<StageTexts>(stage)));
}

TEST(Parse, TextOfAnyPipelineGivesItBack) {
  EXPECT_TRUE(rc::check("text and back", [] {
    const StageTexts stages = *pipelines();
    RC_ASSERT(parse_pipeline(to_text(stages)) == stages);
  }));
}

TEST(Parse, JsonOfAnyPipelineGivesItBack) {
  EXPECT_TRUE(rc::check("JSON and back", [] {
    const StageTexts stages = *pipelines();
    auto json = nlohmann::ordered_json::array();
    StageTexts expected;
    for (const StageText& stage : stages) {
      json.push_back({{"type", stage.name}});
      expected.push_back({stage.name, {}, ""});
      for (const OptionText& option : stage.options) {
        const bool ascii = std::all_of(option.value.begin(), option.value.end(), [](char c) { return c > 0; });
        if (!ascii || json.back().contains(option.name)) continue;  // JSON holds UTF-8, and a key once
        json.back()[option.name] = option.value;
        expected.back().options.push_back(option);
      }
    }
    RC_ASSERT(parse_pipeline(json.dump()) == expected);
  }));
}

TEST(Parse, AnyTextIsAPipelineOrAUsageError) {
  EXPECT_TRUE(rc::check("any text", [] {
    const std::string text =
        *rc::gen::container<std::string>(rc::gen::elementOf(std::string("ab1,,||()()[]==='\"\\ {}:")));
    try {
      RC_ASSERT(!parse_pipeline(text).empty());
    } catch (const UsageError&) {
    }
  }));
}

TEST(AbsoluteFiles, AreThoseOfOptionsThatNameFiles) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a b.las", "").string(), pattern = (folder / "*.las").string();
  const auto relative = [](const std::string& path) { return std::filesystem::relative(path).string(); };
  const auto absolute = [](const std::string& text) { return with_absolute_files(text); };
  EXPECT_EQ(absolute("knn(k=8) | distance_to('" + relative(file) + "')"), "knn(k=8) | distance_to(\"" + file + "\")");
  EXPECT_EQ(absolute("take('" + relative(pattern) + "', attributes=z)"), "take(\"" + pattern + "\", attributes=z)");
  for (const std::string text : {"distance_to(nowhere.las)", "crop(polygon=\"POLYGON ((0 0, 1 0, 1 1, 0 0))\")",
                                 "set(a = b * c)", "none(x=1)", "transform(matrix=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1])"})
    EXPECT_EQ(parse_pipeline(absolute(text)), parse_pipeline(text)) << text;
}

}  // namespace
}  // namespace pointsweep
