// SPDX-License-Identifier: MIT
/// The law of --memory: every operator stays below the budget, both with the least budget that it accepts and with the
/// least budget that has room for 16 threads.
#include <nlohmann/json.hpp>

#include "tests/cli/tool.h"
#include "tests/support/examples.h"
#include "tests/support/sanitizers.h"

namespace pointsweep {
namespace {

class MemoryLaw : public Tool, public testing::WithParamInterface<std::string> {
 protected:
  MemoryLaw() {
    write_points(folder_ / "in.ply", cloud_for_examples(100000, 1));
    write_labelled_points(folder_ / "other.ply", cloud_for_examples(20000, 2));
  }

  /// Returns the command of the operator's example with a budget of `mega` MB.
  std::string command(std::uint64_t mega) const {
    return "run in.ply out.ply --force --quiet --threads 16 --stats stats.json --memory " + std::to_string(mega) +
           "M --pipeline '" + example_of(GetParam(), "other.ply").pipeline + "'";
  }

  /// Returns the number of MB that follows `words` in a text; `otherwise` if the text does not have the words.
  static std::uint64_t mega_behind(const std::string& words, const std::string& text, std::uint64_t otherwise) {
    const std::size_t at = text.find(words);
    return at == std::string::npos ? otherwise : std::stoull(text.substr(at + words.size()));
  }
  /// Returns the least budget in MB that is accepted.
  std::uint64_t least_mega() {
    const Result refused = tool(command(1));
    EXPECT_TRUE(refused.status == 0 || refused.err.find("give --memory ") != std::string::npos) << refused.err;
    return mega_behind("give --memory ", refused.err, 48);
  }
  /// Returns the least budget in MB that has room for all threads.
  std::uint64_t mega_for_all_threads(std::uint64_t least) {
    return mega_behind("no room for more; --memory ", made(command(least) + " --dry-run", ".out"), least);
  }
};

TEST_P(MemoryLaw, TheLeastMemoryIsNeverExceeded) {
  if (has_sanitizer()) GTEST_SKIP() << "sanitizers take memory of their own";
  const std::uint64_t least = least_mega();
  for (const std::uint64_t mega : {least, mega_for_all_threads(least)}) {
    made(command(mega));
    const auto statistics = nlohmann::json::parse(contents(folder_ / "stats.json"));
    EXPECT_LE(statistics["peak_rss_bytes"].get<std::uint64_t>(), mega << 20) << command(mega);
    EXPECT_TRUE(mega == least || statistics["threads"] == 16) << command(mega);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryOperator, MemoryLaw, testing::ValuesIn(names_of_all_operators()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace pointsweep
