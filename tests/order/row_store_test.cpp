// SPDX-License-Identifier: MIT
#include "pointsweep/order/row_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <optional>
#include <random>
#include <thread>
#include <vector>

#include "pointsweep/storage/local/temp_folder.h"

namespace pointsweep {
namespace {

struct Case {
  std::uint64_t rows;
  std::size_t record_bytes;
  bool spilled;
  std::size_t buffer_bytes;
  std::uint64_t missing_every;  ///< rows divisible by it are never put; 0: all rows are put
};

std::byte byte_of(std::uint64_t row, std::size_t i) {
  return static_cast<std::byte>((row * 2654435761u >> 7) + i * 31);
}

void put_all(RowStore& store, const Case& c, std::size_t threads) {
  std::vector<std::uint64_t> rows;
  for (std::uint64_t row = 0; row < c.rows; ++row)
    if (c.missing_every == 0 || row % c.missing_every != 0) rows.push_back(row);
  std::shuffle(rows.begin(), rows.end(), std::mt19937_64(7));
  const auto put = [&](std::size_t thread) {
    const std::size_t batch = 777;
    for (std::size_t i = thread * batch; i < rows.size(); i += threads * batch) {
      const std::span<const std::uint64_t> some(&rows[i], std::min(batch, rows.size() - i));
      std::vector<std::byte> records;
      for (const std::uint64_t row : some)
        for (std::size_t b = 0; b < c.record_bytes; ++b) records.push_back(byte_of(row, b));
      store.put(some, records);
    }
  };
  std::vector<std::thread> workers;
  for (std::size_t t = 0; t < threads; ++t) workers.emplace_back(put, t);
  for (std::thread& worker : workers) worker.join();
}

void check(const Case& c) {
  SCOPED_TRACE(testing::Message() << c.rows << " rows of " << c.record_bytes << " bytes, spilled " << c.spilled
                                  << ", buffers " << c.buffer_bytes);
  std::vector<std::byte> fill;
  for (std::size_t b = 0; b < c.record_bytes; ++b) fill.push_back(std::byte(0xff - b));
  std::optional<TempFolder> folder;
  if (c.spilled) folder.emplace(std::filesystem::temp_directory_path());
  RowStore store(c.rows, fill, c.spilled ? &*folder : nullptr, c.buffer_bytes);
  put_all(store, c, 3);
  std::uint64_t next = 0;
  store.drain([&](std::uint64_t first, std::span<const std::byte> records) {
    ASSERT_EQ(first, next);
    ASSERT_EQ(records.size() % c.record_bytes, 0u);
    for (std::size_t at = 0; at < records.size(); at += c.record_bytes, ++next)
      for (std::size_t b = 0; b < c.record_bytes; ++b) {
        const bool missing = c.missing_every != 0 && next % c.missing_every == 0;
        ASSERT_EQ(records[at + b], missing ? fill[b] : byte_of(next, b)) << "row " << next;
      }
  });
  EXPECT_EQ(next, c.rows);
  EXPECT_EQ(store.spilled_bytes() > 0, c.spilled && c.rows > (c.missing_every == 1 ? c.rows : 0));
}

TEST(RowStore, InMemoryPutsEveryRecordAtItsRow) {
  for (const std::size_t bytes : {1, 3, 4, 8, 12, 16, 32, 52}) check({20000, bytes, false, 0, 0});
}

TEST(RowStore, SpilledPutsEveryRecordAtItsRow) {
  for (const std::size_t bytes : {1, 3, 4, 8, 12, 16, 32, 52}) check({20000, bytes, true, 1 << 20, 0});
}

TEST(RowStore, WithTinyBuffersReadsItsBucketsMoreThanOnce) {
  check({50000, 12, true, 4096, 0});
  check({50000, 12, true, 20000, 0});
  check({3000, 100, true, 1, 0});
}

TEST(RowStore, FillsRowsThatWereNotPut) {
  for (const bool spilled : {false, true})
    for (const std::uint64_t every : {1, 2, 1000}) check({10000, 12, spilled, 1 << 16, every});
}

TEST(RowStore, HoldsRecordsThatAreLargerThanItsRuns) {
  constexpr std::size_t kRecord = 5'000'001;  // as of 600,000 neighbours
  for (const std::byte value : {std::byte{0}, std::byte{7}}) {
    RowStore store(3, std::vector<std::byte>(kRecord, value), nullptr, 0);
    const std::vector<std::byte> record(kRecord, std::byte{9});
    store.put(std::vector<std::uint64_t>{1}, record);
    std::vector<std::byte> all;
    store.drain([&](std::uint64_t, std::span<const std::byte> records) {
      all.insert(all.end(), records.begin(), records.end());
    });
    ASSERT_EQ(all.size(), 3 * kRecord);
    for (std::size_t row = 0; row < 3; ++row)
      EXPECT_EQ(
          std::count(all.begin() + static_cast<std::ptrdiff_t>(row * kRecord),
                     all.begin() + static_cast<std::ptrdiff_t>((row + 1) * kRecord), row == 1 ? record[0] : value),
          static_cast<std::ptrdiff_t>(kRecord))
          << row;
  }
}

TEST(RowStore, MayBeEmpty) {
  for (const bool spilled : {false, true}) check({0, 12, spilled, 1 << 16, 0});
}

TEST(RowStore, HasRowsPastFourBillion) {
  // Few of the rows are put, one byte each. Memory never holds more than the buffers.
  const TempFolder folder(std::filesystem::temp_directory_path());
  constexpr std::uint64_t kRows = 4'300'000'000;
  RowStore store(kRows, {std::byte{0}}, &folder, 64 << 20);
  const std::vector<std::uint64_t> rows = {kRows - 1, 4'294'967'296, 4'294'967'295, 17};
  const std::vector<std::byte> records = {std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4}};
  store.put(rows, records);
  std::uint64_t next = 0;
  std::vector<std::pair<std::uint64_t, std::byte>> found;
  store.drain([&](std::uint64_t first, std::span<const std::byte> run) {
    ASSERT_EQ(first, next);
    next += run.size();
    const auto inside = [&](std::uint64_t row) { return first <= row && row < next; };
    if (std::ranges::none_of(rows, inside)) {
      ASSERT_EQ(run.front(), std::byte{0});
      ASSERT_EQ(run.back(), std::byte{0});
      return;
    }
    for (std::size_t i = 0; i < run.size(); ++i)
      if (run[i] != std::byte{0}) found.emplace_back(first + i, run[i]);
  });
  EXPECT_EQ(next, kRows);
  const std::vector<std::pair<std::uint64_t, std::byte>> expected = {
      {17, std::byte{4}}, {4'294'967'295, std::byte{3}}, {4'294'967'296, std::byte{2}}, {kRows - 1, std::byte{1}}};
  EXPECT_EQ(found, expected);
}

TEST(RowStore, GoesOnFromWhereItWasEncoded) {
  const TempFolder folder(std::filesystem::temp_directory_path());
  const SpillPlace kept = SpillPlace::kept(folder.path() / "rows");
  constexpr std::size_t kRows = 5000;
  const auto put = [](RowStore& store, std::uint64_t first, std::uint64_t end, std::uint64_t added) {
    for (std::uint64_t row = first; row < end; ++row) {
      const std::uint64_t value = row + added;
      store.put({&row, 1}, std::as_bytes(std::span(&value, 1)));
    }
  };
  std::vector<std::byte> bytes;
  {
    RowStore store(kRows, std::vector<std::byte>(8), kept, 1 << 16);
    put(store, 0, 1000, 7);
    bytes = encoded(store);  // the second encoding has the rows that are put between both
    put(store, 1000, 2500, 7);
    bytes = encoded(store);
    put(store, 2500, 4000, 99);  // lost
  }
  Decoder saved(bytes);
  RowStore store(saved, kRows, std::vector<std::byte>(8), kept, 1 << 20);
  saved.finish();
  put(store, 2500, kRows, 7);
  std::vector<std::byte> all;
  store.drain([&](std::uint64_t, std::span<const std::byte> records) {
    all.insert(all.end(), records.begin(), records.end());
  });
  ASSERT_EQ(all.size(), kRows * 8);
  for (std::uint64_t row = 0; row < kRows; ++row) {
    std::uint64_t value;
    std::memcpy(&value, all.data() + 8 * row, 8);
    ASSERT_EQ(value, row + 7);
  }
}

}  // namespace
}  // namespace pointsweep
