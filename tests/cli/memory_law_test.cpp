// SPDX-License-Identifier: MIT
/// The law of --memory: every operator, in the least memory that it accepts, stays below it, with many threads.
#include <nlohmann/json.hpp>

#include "tests/cli/tool.h"
#include "tests/support/examples.h"

namespace pointsweep {
namespace {

class MemoryLaw : public Tool, public testing::WithParamInterface<std::string> {
 protected:
  MemoryLaw() {
    write_points(folder_ / "in.ply", cloud_for_examples(100000, 1));
    write_points(folder_ / "other.ply", cloud_for_examples(20000, 2));
  }

  /// The command of the example in so many MB.
  std::string command(std::uint64_t mega) const {
    return "run in.ply out.ply --force --quiet --threads 16 --stats stats.json --memory " + std::to_string(mega) +
           "M --pipeline '" + example_of(GetParam(), "other.ply").pipeline + "'";
  }

  /// The least MB that are accepted; those of a run that is not refused are what it needs at most.
  std::uint64_t least_mega() {
    const Result refused = tool(command(1));
    const std::string give = "give --memory ";
    const std::size_t at = refused.err.find(give);
    EXPECT_TRUE(refused.status == 0 || at != std::string::npos) << refused.err;
    return at == std::string::npos ? 48 : std::stoull(refused.err.substr(at + give.size()));
  }
};

TEST_P(MemoryLaw, TheLeastMemoryIsNeverExceeded) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers take memory of their own";
#endif
  const std::uint64_t mega = least_mega();
  made(command(mega));
  const auto statistics = nlohmann::json::parse(contents(folder_ / "stats.json"));
  EXPECT_LE(statistics["peak_rss_bytes"].get<std::uint64_t>(), mega << 20) << command(mega);
}

INSTANTIATE_TEST_SUITE_P(EveryOperator, MemoryLaw, testing::ValuesIn(names_of_all_operators()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace pointsweep
