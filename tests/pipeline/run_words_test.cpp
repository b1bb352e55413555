// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/run_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/pipeline/refusal.h"

namespace pointsweep {
namespace {

TEST(WordsOfRuns, AreTakenAndGivenBackForEveryOption) {
  std::set<std::string> names;
  for (const RunWords& declaration : run_words()) {
    EXPECT_TRUE(names.insert(declaration.name).second) << declaration.name;
    EXPECT_EQ(&run_words(declaration.name), &declaration);
    EXPECT_EQ(declaration.current(RunOptions()), "") << declaration.name;
    std::size_t defaults = 0;
    for (const std::string& word : declaration.words) {
      RunOptions options;
      set_word(options, declaration.name, word);
      const std::string current = declaration.current(options);
      EXPECT_TRUE(current == word || current.empty()) << declaration.name << " " << word;
      defaults += current.empty();
    }
    EXPECT_LE(defaults, 1u) << declaration.name;
  }
}

TEST(WordsOfRuns, SetTheOptionOfTheirNameAndNoOther) {
  RunOptions options;
  set_word(options, "order", "sweep");
  set_word(options, "axis", "y");
  set_word(options, "engine", "reference");
  set_word(options, "nonfinite", "refuse");
  set_word(options, "positions", "float32");
  EXPECT_FALSE(options.input_paths);
  set_word(options, "provenance", "paths");
  EXPECT_EQ(options.order, Order::sweep);
  EXPECT_EQ(options.axis, 1);
  EXPECT_EQ(options.engine, Engine::reference);
  EXPECT_EQ(options.nonfinite, Nonfinite::refuse);
  EXPECT_EQ(options.positions, Type::f32);
  EXPECT_TRUE(options.input_paths && options.provenance);
  set_word(options, "axis", "auto");
  EXPECT_EQ(options.axis, std::nullopt);
}

TEST(WordsOfRuns, OthersAreRefusedWithTheList) {
  RunOptions options;
  EXPECT_EQ(refusal([&] { set_word(options, "nonfinite", "skip"); }),
            "--nonfinite: 'skip' is not keep, drop or refuse.");
  EXPECT_EQ(refusal([&] { set_word(options, "order", ""); }), "--order: '' is not input or sweep.");
}

}  // namespace
}  // namespace pointsweep
