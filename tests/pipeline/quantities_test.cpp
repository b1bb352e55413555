// SPDX-License-Identifier: MIT
#include "pointsweep/program/quantities.h"

#include <gtest/gtest.h>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

TEST(Quantities, SizesUsePowersOf1024) {
  EXPECT_EQ(parse_size("--memory", "1B"), 1u);
  EXPECT_EQ(parse_size("--memory", "256M"), 256u << 20);
  EXPECT_EQ(parse_size("--memory", "1.5g"), 3u << 29);
  EXPECT_EQ(parse_size("--memory", "2T"), std::uint64_t{2} << 40);
  EXPECT_EQ(parse_size("--memory", "18446744073709551615B"), ~std::uint64_t{0});
}

TEST(Quantities, TheUnitOfASizeMayBeWrittenInThreeWays) {
  for (const char* text : {"4G", "4g", "4GB", "4gb", "4GiB", "4gib", "4GIB"})
    EXPECT_EQ(parse_size("--memory", text), std::uint64_t{4} << 30) << text;
  for (const char* text : {"4M", "4MB", "4MiB"}) EXPECT_EQ(parse_size("--memory", text), 4u << 20) << text;
  EXPECT_EQ(parse_size("--memory", "1.5GiB"), 3u << 29);
}

TEST(Quantities, ASizeWithoutUnitIsRefusedAndTheUnitsAreNamed) {
  for (const char* text : {"4", "800000000", "1.5", "1e9"}) {
    try {
      parse_size("--memory", text);
      ADD_FAILURE() << text;
    } catch (const UsageError& error) {
      for (const char* unit : {"4G", "4GB", "4GiB", "M", "T"})
        EXPECT_NE(std::string(error.what()).find(unit), std::string::npos) << error.what();
    }
  }
}

TEST(Quantities, CountsUsePowersOf1000) {
  EXPECT_EQ(parse_count("-n", "0"), 0u);
  EXPECT_EQ(parse_count("-n", "20M"), 20'000'000u);
  EXPECT_EQ(parse_count("-n", "2.5k"), 2500u);
  EXPECT_EQ(parse_count("-n", "10G"), 10'000'000'000u);
  EXPECT_EQ(parse_count("-n", "1e6"), 1'000'000u);
  EXPECT_EQ(parse_count("-n", "9007199254740993"), 9007199254740993u) << "exact beyond 2^53";
}

TEST(Quantities, NonsenseIsRefusedWithTheNameOfTheOption) {
  for (const char* text : {"", "M", "-1", "1.5", "12Q", "5MX", "1 M", "nan", "inf", "99999999999T",
                           "18446744073709551616", "5iB", "5Mi", "5BB", "B", "iB"}) {
    EXPECT_THROW(parse_count("-n", text), UsageError) << text;
    EXPECT_THROW(parse_size("--memory", text), UsageError) << text;
  }
  EXPECT_THROW(parse_count("-n", "5MB"), UsageError);
  EXPECT_THROW(parse_size("--memory", "0B"), UsageError);
  try {
    parse_size("--memory", "much");
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).find("--memory: 'much' is not a size"), 0u) << error.what();
  }
}

TEST(Quantities, VectorsAreThreeFiniteNumbers) {
  EXPECT_EQ(parse_vector("--origin", "1,-2.5,3e5"), (Vec3{1, -2.5, 3e5}));
  for (const char* text : {"", "1,2", "1,2,3,4", "1,2,3,", "1;2;3", "a,b,c", "1,,3", "nan,0,0"})
    EXPECT_THROW(parse_vector("--origin", text), UsageError) << text;
}

TEST(Quantities, AreShownWithThreeDigits) {
  EXPECT_EQ(size_text(800), "800");
  EXPECT_EQ(size_text(1012), "1012");
  EXPECT_EQ(size_text(256u << 20), "256M");
  EXPECT_EQ(size_text(std::uint64_t{7} << 29), "3.50G");
  EXPECT_EQ(count_text(9999), "9999");
  EXPECT_EQ(count_text(12'345'678), "12.3M");
  EXPECT_EQ(count_text(999'999), "1.00M");
  EXPECT_EQ(duration_text(7.4), "0:07");
  EXPECT_EQ(duration_text(3723), "1:02:03");
}

}  // namespace
}  // namespace pointsweep
