// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_header.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/formats/las_test_file.h"

namespace pointsweep {
namespace {

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::array<std::uint64_t, 16> some_returns() {
  std::array<std::uint64_t, 16> by_return{};
  for (std::size_t r = 0; r < 16; ++r) by_return[r] = 100 + r;
  return by_return;
}

TEST(LasHeader, CountsOfOldVersionsAreTheLegacyCounts) {
  LasHeader header;
  header.minor = 2;
  set_counts(header, 4294967295u, some_returns());
  EXPECT_EQ(header.legacy_count, 4294967295u);
  EXPECT_EQ(header.legacy_by_return, (std::array<std::uint32_t, 5>{101, 102, 103, 104, 105}));
}

TEST(LasHeader, CountsOfLas14AreAlsoLegacyCountsForOldPointFormatsThatFit) {
  LasHeader header;
  for (const auto& [format, count, legacy] :
       {std::tuple{5, std::uint64_t{4294967295u}, 4294967295u}, {5, 4294967296u, 0u}, {6, 10u, 0u}}) {
    header.point_format = static_cast<std::uint8_t>(format);
    set_counts(header, count, some_returns());
    EXPECT_EQ(header.count, count);
    EXPECT_EQ(header.legacy_count, legacy);
    EXPECT_EQ(header.legacy_by_return[0], legacy == 0 ? 0u : 101u);
    EXPECT_EQ(header.by_return[14], 115u);
  }
}

TEST(LasHeader, AnUpgradeKeepsAllEntriesAndTheBytesBehind) {
  for (const int minor : {0, 2, 3}) {
    las_test::File file;
    file.minor = minor;
    file.user_header = "behind";
    const std::string old = file.bytes();
    std::vector<std::string> warnings;
    LasHeader header = parse_las_header(std::as_bytes(std::span(old)), old.size(), "a", warnings);
    header.bytes.resize(header.header_size);
    std::memcpy(header.bytes.data(), old.data(), header.header_size);
    upgrade_las_header(header, 4);
    const std::string upgraded = text_of(serialize(header));
    ASSERT_EQ(upgraded.size(), 375u + 6);
    EXPECT_EQ(upgraded.substr(375), "behind");
    EXPECT_EQ(upgraded[25], 4);
    EXPECT_EQ(las_test::get<std::uint16_t>(upgraded, 94), 381);
    std::string kept = old.substr(0, 25);
    if (minor < 2) kept.replace(6, 2, 2, '\0');  // the global encoding replaces reserved bytes of LAS 1.1 and earlier
    EXPECT_EQ(upgraded.substr(0, 25), kept);
    EXPECT_EQ(upgraded.substr(26, 94 - 26), old.substr(26, 94 - 26));
    EXPECT_EQ(upgraded.substr(96, 227 - 96), old.substr(96, 227 - 96));
    EXPECT_EQ(upgraded.substr(235, 140), std::string(140, '\0'));
  }
}

TEST(LasHeader, ANewOneIsLas14WithoutADate) {
  const std::string bytes = text_of(serialize(new_las_header()));
  ASSERT_EQ(bytes.size(), 375u);
  EXPECT_EQ(bytes.substr(0, 4), "LASF");
  EXPECT_EQ(bytes[24], 1);
  EXPECT_EQ(bytes[25], 4);
  EXPECT_EQ(bytes.substr(58, 10), "pointsweep");
  EXPECT_EQ(las_test::get<std::uint32_t>(bytes, 90), 0u);
}

}  // namespace
}  // namespace pointsweep
