// SPDX-License-Identifier: MIT
#include "pointsweep/program/run_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/pipeline/refusal.h"

namespace pointsweep {
namespace {

void set_option(RunOptions& options, const std::string& name, const std::string& text) {
  run_option(name).set(options, text, "--" + name);
}

/// A value of each option that has no fixed list of words.
const std::map<std::string, std::string> kSamplesOfOptions = {
    {"replace", "a,b"},         {"prefix", "p_"},   {"memory", "268435456B"},  {"temp_folder", "/tmp"},
    {"threads", "3"},           {"resume", "here"}, {"scale", "0.001"},        {"offset", "auto"},
    {"decimals", "3"},          {"tile", "62.5"},   {"tile_origin", "1,-2.5"}, {"tile_buffer", "20"},
    {"split", "classification"}};

TEST(OptionsOfRuns, AreTakenAndGivenBack) {
  std::set<std::string> names;
  for (const RunOption& option : run_options()) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_EQ(&run_option(option.name), &option);
    EXPECT_EQ(option.text(RunOptions()), "") << option.name;
    std::vector<std::string> values = option.words;
    if (values.empty()) values.push_back(option.value.empty() ? kSwitchedOn : kSamplesOfOptions.at(option.name));
    std::size_t defaults = 0;
    for (const std::string& value : values) {
      RunOptions options;
      set_option(options, option.name, value);
      const std::string text = option.text(options);
      EXPECT_TRUE(text == value || text.empty()) << option.name << " " << value;
      defaults += text.empty();
      for (const RunOption& other : run_options()) {
        if (&other == &option) continue;
        EXPECT_EQ(other.text(options), "") << option.name << " sets " << other.name;
      }
      const bool in_identity = !text.empty() && option.effect != RunOption::Effect::none;
      EXPECT_EQ(identity_text(options) != identity_text(RunOptions()), in_identity) << option.name << " " << value;
    }
    EXPECT_LE(defaults, option.words.empty() ? 0u : 1u) << option.name;
  }
}

TEST(OptionsOfRuns, SetTheMemberOfTheirName) {
  RunOptions options;
  set_option(options, "order", "sweep");
  set_option(options, "axis", "y");
  set_option(options, "engine", "reference");
  set_option(options, "nonfinite", "refuse");
  set_option(options, "positions", "float32");
  EXPECT_FALSE(options.input_paths);
  set_option(options, "provenance", "paths");
  set_option(options, "memory", "1.5G");
  set_option(options, "threads", "7");
  set_option(options, "scale", "0.5,0.25,1");
  set_option(options, "offset", "1,2,-3");
  EXPECT_EQ(options.layout.scale, (Vec3{0.5, 0.25, 1}));
  EXPECT_EQ(options.layout.offset->at, (Vec3{1, 2, -3}));
  EXPECT_EQ(run_option("offset").text(options), "1,2,-3");
  EXPECT_EQ(options.order, Order::sweep);
  EXPECT_EQ(options.axis, 1);
  EXPECT_EQ(options.engine, Engine::reference);
  EXPECT_EQ(options.nonfinite, Nonfinite::refuse);
  EXPECT_EQ(options.positions, Type::f32);
  EXPECT_TRUE(options.input_paths && options.provenance);
  EXPECT_EQ(options.resources.memory_bytes, std::uint64_t{3} << 29);
  EXPECT_EQ(options.resources.threads, 7u);
  set_option(options, "axis", "auto");
  EXPECT_EQ(options.axis, std::nullopt);
}

TEST(OptionsOfRuns, OtherValuesAreRefusedWithThoseThatAreAllowed) {
  RunOptions options;
  EXPECT_EQ(refusal([&] { set_option(options, "nonfinite", "skip"); }),
            "--nonfinite: 'skip' is not keep, drop or refuse.");
  EXPECT_EQ(refusal([&] { set_option(options, "order", ""); }), "--order: '' is not input or sweep.");
  for (const char* text : {"0", "-1", "4097", "x", "1.5", ""})
    EXPECT_EQ(refusal([&] { set_option(options, "threads", text); }),
              fmt::format("--threads: '{}' is not a whole number from 1 to 4096.", text));
  EXPECT_EQ(refusal([&] { set_option(options, "replace", "a,"); }),
            "--replace: 'a,' is not a list of attributes such as normal,splat_length.");
}

}  // namespace
}  // namespace pointsweep
