// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/las/copc_layout.h"
#include "tests/support/scratch_in_memory.h"

namespace pointsweep {
namespace {

constexpr std::size_t kRecordBytes = 30;  // point format 6

class CopcNodesOfPoints : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_codecs()) GTEST_SKIP() << "this build has no LAZ codec";
    laz_ = LazLayout::for_format(6, 0, LazLayout::kVariable, "a.copc.laz");
  }
  CopcNodes nodes(std::uint64_t memory, std::uint64_t most_node_bytes) {
    return {*laz_, kRecordBytes, memory, most_node_bytes, std::make_unique<ScratchInMemory>(), "a.copc.laz"};
  }
  std::optional<LazLayout> laz_;
};

TEST_F(CopcNodesOfPoints, StandByDepthThenAlongTheCurveWithoutGaps) {
  CopcNodes all = nodes(1000, 1 << 20);
  std::mt19937_64 random(1);
  std::uint64_t points = 0;
  for (std::uint32_t cell = 0; cell < 4096; ++cell) {
    const CurveKey key = key_of_cell({cell << 19, 0, 0});
    std::byte record[kRecordBytes] = {};
    std::memcpy(record, &cell, sizeof cell);
    all.add(key, static_cast<int>(random() % 4), record);
    ++points;
  }
  std::uint64_t at = 500;
  const std::vector<CopcNode> found = all.finish(at, [&](std::uint64_t offset, std::span<const std::byte> bytes) {
    EXPECT_EQ(offset, at);
    at += bytes.size();
  });
  ASSERT_EQ(found.size(), 1u + 2 + 4 + 8) << "the octants along x";
  std::uint64_t in_nodes = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    in_nodes += found[i].points;
    if (i == 0) continue;
    EXPECT_EQ(found[i].offset, found[i - 1].offset + found[i - 1].bytes);
    const bool is_deeper = found[i].octant.depth > found[i - 1].octant.depth;
    EXPECT_TRUE(is_deeper || found[i].octant.at[0] == found[i - 1].octant.at[0] + 1);
  }
  EXPECT_EQ(in_nodes, points);
  EXPECT_EQ(found.back().offset + found.back().bytes, at);
}

TEST_F(CopcNodesOfPoints, AreRefusedWhereOneIsTooLarge) {
  CopcNodes all = nodes(1000, 100 * kRecordBytes);
  const std::byte record[kRecordBytes] = {};
  for (int i = 0; i < 100; ++i) all.add({}, 3, record);
  try {
    all.add({}, 3, record);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("a.copc.laz: more than 100 points lie so close together"));
  }
}

}  // namespace
}  // namespace pointsweep
