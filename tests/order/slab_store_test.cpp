// SPDX-License-Identifier: MIT
#include "pointsweep/order/slab_store.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <thread>

#include "pointsweep/storage/local/temp_folder.h"

namespace pointsweep {
namespace {

/// Returns records of `size` bytes that hold their number.
std::vector<std::byte> numbered(std::uint64_t first, std::uint64_t count, std::size_t size) {
  std::vector<std::byte> bytes(count * size);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t number = first + i;
    std::memcpy(&bytes[i * size], &number, std::min(size, sizeof number));
  }
  return bytes;
}

std::vector<std::byte> read(const SlabStore& store, std::size_t slab, std::uint64_t first, std::uint64_t count,
                            std::size_t size) {
  std::vector<std::byte> bytes(count * size);
  store.read(slab, first, bytes);
  return bytes;
}

std::filesystem::path temp() { return std::filesystem::temp_directory_path(); }

TEST(SlabStore, GivesBackAnyRangeOfAnySlabInTheOrderStored) {
  const TempFolder folder(temp());
  rc::check([&] {
    const std::size_t size = *rc::gen::inRange<std::size_t>(1, 40);
    const std::size_t slabs = *rc::gen::inRange<std::size_t>(1, 5);
    SlabStore store(slabs, size, *rc::gen::inRange<std::size_t>(1, 300),
                    *rc::gen::arbitrary<bool>() ? &folder : nullptr);
    std::vector<std::vector<std::byte>> expected(slabs);
    std::uint64_t next = 0;
    for (int i = *rc::gen::inRange(0, 60); i > 0; --i) {
      const auto slab = *rc::gen::inRange<std::size_t>(0, slabs);
      const auto records = numbered(next, *rc::gen::inRange<std::uint64_t>(0, 50), size);
      next += records.size() / size;
      store.append(slab, records);
      expected[slab].insert(expected[slab].end(), records.begin(), records.end());
    }
    store.finish();
    for (std::size_t slab = 0; slab < slabs; ++slab) {
      const std::uint64_t count = expected[slab].size() / size;
      RC_ASSERT(store.count(slab) == count);
      const auto first = *rc::gen::inRange<std::uint64_t>(0, count + 1);
      const auto n = *rc::gen::inRange<std::uint64_t>(0, count - first + 1);
      const auto begin = expected[slab].begin() + static_cast<std::ptrdiff_t>(first * size);
      const auto got = read(store, slab, first, n, size);
      RC_ASSERT(std::equal(got.begin(), got.end(), begin));
    }
  });
}

TEST(SlabStore, TakesRecordsOfManyThreadsWhole) {
  constexpr std::size_t kSize = 12, kThreads = 4, kSlabs = 3;
  constexpr std::uint64_t kEach = 30000;
  const TempFolder folder(temp());
  for (const TempFolder* spill : {static_cast<const TempFolder*>(nullptr), &folder}) {
    SlabStore store(kSlabs, kSize, 1000, spill);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < kThreads; ++t)
      threads.emplace_back([&store, t] {
        for (std::uint64_t i = 0; i < kEach; i += 100)
          store.append(i / 100 % kSlabs, numbered(t * kEach + i, 100, kSize));
      });
    for (std::thread& thread : threads) thread.join();
    store.finish();
    std::vector<std::uint64_t> numbers;
    for (std::size_t slab = 0; slab < kSlabs; ++slab) {
      const auto records = read(store, slab, 0, store.count(slab), kSize);
      for (std::size_t at = 0; at < records.size(); at += kSize) {
        std::memcpy(&numbers.emplace_back(), &records[at], sizeof(std::uint64_t));
        ASSERT_EQ(numbers.back() % kEach / 100 % kSlabs, slab);
      }
    }
    std::ranges::sort(numbers);
    ASSERT_EQ(numbers.size(), kThreads * kEach);
    for (std::uint64_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(numbers[i], i);
  }
}

TEST(SlabStore, SpillsEveryByteAndThenHoldsNearlyNoMemory) {
  const TempFolder folder(temp());
  SlabStore store(2, 16, 4096, &folder);
  store.append(0, numbered(0, 10000, 16));
  store.append(1, numbered(0, 3, 16));
  EXPECT_GE(store.memory_bytes(), 2u * 4096);
  store.finish();
  EXPECT_EQ(store.spilled_bytes(), 10003u * 16);
  EXPECT_LT(store.memory_bytes(), 4096u);
}

TEST(SlabStore, InMemoryHoldsLittleMoreThanItsRecords) {
  SlabStore store(2, 16, 4096, nullptr);
  store.append(0, numbered(0, 100000, 16));
  store.finish();
  EXPECT_GE(store.memory_bytes(), 1600000u);
  EXPECT_LE(store.memory_bytes(), 1700000u);
  EXPECT_EQ(store.spilled_bytes(), 0u);
}

TEST(SlabStore, UsesTheSpaceOfReleasedSlabsAgain) {
  SlabStore store(1, 16, 4096, nullptr);
  store.append(0, numbered(0, 100000, 16));
  store.finish();
  const std::uint64_t full = store.memory_bytes();
  store.release(0);
  EXPECT_EQ(store.count(0), 0u);
  EXPECT_LT(store.memory_bytes(), 4096u);
  const std::size_t slab = store.add_slabs(1);
  const auto records = numbered(5, 100000, 16);
  store.append(slab, records);
  store.finish();
  EXPECT_LE(store.memory_bytes(), full + 4096);
  EXPECT_EQ(read(store, slab, 0, 100000, 16), records);
}

TEST(SlabStore, FillsTheSpaceOfReleasedBlocksInTheFileAgain) {
  const TempFolder folder(temp());
  const std::filesystem::path file = folder.path() / "kept";
  SlabStore store(3, 16, 4096, SpillPlace::kept(file));
  const auto records = numbered(0, 100000, 16), others = numbered(7, 1000, 16);
  for (std::size_t at = 0; at < records.size(); at += 1600) {  // blocks of both slabs by turns
    store.append(0, std::span(records).subspan(at, 1600));
    store.append(1, std::span(others).subspan(at / 100, 16));
  }
  store.finish();
  const std::uintmax_t full = std::filesystem::file_size(file);
  const std::size_t again = store.add_slabs(2);
  for (std::uint64_t at = 0; at < 100000; at += 1000) {
    store.release_before(0, at);
    const std::vector<std::byte> some = read(store, 0, at, 1000, 16);
    store.append(again + at % 2000 / 1000, some);
  }
  store.release(0);
  store.finish();
  EXPECT_LE(std::filesystem::file_size(file), full + 8 * 4096);
  EXPECT_EQ(read(store, 1, 0, 1000, 16), others);
  for (std::uint64_t at = 0; at < 100000; at += 1000)
    EXPECT_EQ(read(store, again + at % 2000 / 1000, at / 2000 * 1000, 1000, 16),
              std::vector(records.begin() + 16 * at, records.begin() + 16 * (at + 1000)));
}

TEST(SlabStore, GivesBackWhatHasBeenReadWhileTheRestStays) {
  const TempFolder folder(temp());
  for (const TempFolder* spill : {static_cast<const TempFolder*>(nullptr), &folder}) {
    SlabStore store(1, 16, 4096, spill);
    const auto records = numbered(0, 100000, 16);
    store.append(0, records);
    store.finish();
    const std::uint64_t full = store.memory_bytes();
    for (const std::uint64_t at : {0u, 1u, 255u, 256u, 50000u, 50100u}) {
      store.release_before(0, at);
      EXPECT_EQ(read(store, 0, at, 100000 - at, 16), std::vector(records.begin() + 16 * at, records.end())) << at;
    }
    EXPECT_LT(store.memory_bytes(), spill == nullptr ? full * 6 / 10 : full + 1);
    store.release(0);
    EXPECT_LT(store.memory_bytes(), 4096u);
  }
}

}  // namespace
}  // namespace pointsweep
