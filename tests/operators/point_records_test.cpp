// SPDX-License-Identifier: MIT
#include "pointsweep/operators/nearest/point_records.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <vector>

namespace pointsweep {
namespace {

/// Scratch in memory that counts the reads.
class CountedScratch final : public Scratch {
 public:
  explicit CountedScratch(std::size_t& reads) : reads_(reads) {}
  void append(std::span<const std::byte> bytes) override { all_.insert(all_.end(), bytes.begin(), bytes.end()); }
  void read(std::uint64_t offset, std::span<std::byte> bytes) const override {
    ++reads_;
    std::copy_n(all_.begin() + static_cast<std::ptrdiff_t>(offset), bytes.size(), bytes.begin());
  }
  void replace(std::uint64_t, std::span<const std::byte>) override { FAIL() << "records do not change"; }

 private:
  std::size_t& reads_;
  std::vector<std::byte> all_;
};

std::vector<std::uint32_t> numbered(std::size_t n) {
  std::vector<std::uint32_t> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<std::uint32_t>(7 * i + 1);
  return values;
}

TEST(PointRecords, AreThoseOfTheirNumbersAlsoWhereFewBlocksFit) {
  constexpr std::size_t kRecords = 500'000;  // about 122 blocks, of which 64 fit
  const std::vector<std::uint32_t> values = numbered(kRecords);
  std::size_t reads = 0;
  PointRecords records(sizeof(std::uint32_t), 0, std::make_unique<CountedScratch>(reads));
  const auto bytes = std::as_bytes(std::span(values));
  for (std::size_t at = 0; at < bytes.size(); at += 40'004)
    records.add(bytes.subspan(at, std::min<std::size_t>(40'004, bytes.size() - at)));
  records.finish();
  EXPECT_EQ(records.count(), kRecords);
  std::mt19937_64 random(1);
  for (int turn = 0; turn < 3; ++turn) {
    std::vector<std::uint64_t> numbers(20'000);
    for (std::uint64_t& number : numbers) number = random() % 10 == 0 ? PointRecords::kNone : random() % kRecords;
    std::vector<std::uint32_t> got(numbers.size(), 3);
    records.gather(numbers, std::as_writable_bytes(std::span(got)));
    for (std::size_t i = 0; i < numbers.size(); ++i)
      ASSERT_EQ(got[i], numbers[i] == PointRecords::kNone ? 3 : values[numbers[i]]);
  }
}

TEST(PointRecords, NearToTheLastOnesAreReadOnce) {
  const std::vector<std::uint32_t> values = numbered(300'000);
  std::size_t reads = 0;
  PointRecords records(sizeof(std::uint32_t), 0, std::make_unique<CountedScratch>(reads));
  records.add(std::as_bytes(std::span(values)));
  records.finish();
  for (std::uint64_t first = 0; first + 10'000 <= values.size(); first += 5'000) {
    std::vector<std::uint64_t> numbers(10'000);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = first + i;
    std::vector<std::uint32_t> got(numbers.size());
    records.gather(numbers, std::as_writable_bytes(std::span(got)));
    ASSERT_EQ(got.back(), values[first + 9'999]);
  }
  EXPECT_LE(reads, 80u);  // 74 blocks, and blocks that are read again after they were dropped
}

}  // namespace
}  // namespace pointsweep
