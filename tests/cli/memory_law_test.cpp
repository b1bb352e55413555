// SPDX-License-Identifier: MIT
/// The law of --memory: every operator stays below it, in the least memory that it accepts and in the least that has
/// room for all of many threads.
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

  /// The command of the example in so many MB.
  std::string command(std::uint64_t mega) const {
    return "run in.ply out.ply --force --quiet --threads 16 --stats stats.json --memory " + std::to_string(mega) +
           "M --pipeline '" + example_of(GetParam(), "other.ply").pipeline + "'";
  }

  /// The number of MB that a text names behind `words`; `otherwise` where it does not have them.
  static std::uint64_t mega_behind(const std::string& words, const std::string& text, std::uint64_t otherwise) {
    const std::size_t at = text.find(words);
    return at == std::string::npos ? otherwise : std::stoull(text.substr(at + words.size()));
  }
  /// The least MB that are accepted; those of a run that is not refused are what it needs at most.
  std::uint64_t least_mega() {
    const Result refused = tool(command(1));
    EXPECT_TRUE(refused.status == 0 || refused.err.find("give --memory ") != std::string::npos) << refused.err;
    return mega_behind("give --memory ", refused.err, 48);
  }
  /// The least MB that have room for all threads.
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
