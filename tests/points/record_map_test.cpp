// SPDX-License-Identifier: MIT
#include "pointsweep/points/record_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <vector>

namespace pointsweep {
namespace {

std::vector<std::byte> some_bytes(std::size_t n, std::mt19937& random) {
  std::vector<std::byte> bytes(n);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

/// A covered byte of the target comes from the last part that covers it. Other bytes are unchanged.
TEST(RecordMap, CopiesEachPartOfEachRecordAndNothingElse) {
  std::mt19937 random(1);
  constexpr std::size_t kFrom = 120, kTo = 140, kRecords = 50;
  for (int turn = 0; turn < 200; ++turn) {
    RecordMap map;
    std::array<std::size_t, kTo> source;
    source.fill(kFrom);  // no part covers the byte
    for (std::size_t part = 0, parts = random() % 6; part < parts; ++part) {
      const std::size_t bytes = random() % 110, from = random() % (kFrom - bytes), to = random() % (kTo - bytes);
      map.add(from, to, bytes);
      for (std::size_t b = 0; b < bytes; ++b) source[to + b] = from + b;
    }
    const std::vector<std::byte> from = some_bytes(kFrom * kRecords, random),
                                 before = some_bytes(kTo * kRecords, random);
    std::vector<std::uint32_t> place(kRecords);
    std::iota(place.begin(), place.end(), 0u);
    std::ranges::shuffle(place, random);
    std::vector<std::byte> expected = before, scattered = before, copied = before, one = before;
    std::vector<std::byte> expected_at_place = before;
    for (std::size_t i = 0; i < kRecords; ++i)
      for (std::size_t b = 0; b < kTo; ++b) {
        if (source[b] == kFrom) continue;
        expected[i * kTo + b] = from[i * kFrom + source[b]];
        expected_at_place[place[i] * kTo + b] = from[i * kFrom + source[b]];
      }
    map.copy(from.data(), kFrom, copied.data(), kTo, kRecords);
    EXPECT_EQ(copied, expected);
    map.scatter(from.data(), kFrom, scattered.data(), kTo, place.data(), kRecords);
    EXPECT_EQ(scattered, expected_at_place);
    for (std::size_t i = 0; i < kRecords; ++i) map.copy(from.data() + i * kFrom, one.data() + i * kTo);
    EXPECT_EQ(one, expected);
  }
}

TEST(RecordMap, CopiesAWholeRecordIfItsPartsLieSideBySide) {
  RecordMap map;
  map.add(0, 0, 4), map.add(4, 4, 8);
  EXPECT_TRUE(map.copies_whole(12));
  EXPECT_FALSE(map.copies_whole(16));
  map.add(12, 16, 4);
  EXPECT_FALSE(map.copies_whole(16));
}

}  // namespace
}  // namespace pointsweep
