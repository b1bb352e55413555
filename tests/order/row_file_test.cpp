// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <filesystem>
#include <vector>

#include "pointsweep/order/row_store.h"
#include "pointsweep/storage/local/temp_folder.h"

namespace pointsweep {
namespace {

std::vector<std::byte> record(std::uint64_t row, std::size_t bytes) {
  std::vector<std::byte> out(bytes);
  for (std::size_t i = 0; i < bytes; ++i) out[i] = static_cast<std::byte>(row * 7 + i * 3 + row / 256);
  return out;
}

TEST(RowFile, GivesBackFromAnyRowWhatWasAppended) {
  const TempFolder folder(std::filesystem::temp_directory_path());
  for (const std::size_t bytes : {1, 24, 61}) {
    for (const TempFolder* spill : {static_cast<const TempFolder*>(nullptr), &folder}) {
      SCOPED_TRACE(std::to_string(bytes) + (spill != nullptr ? " bytes, spilled" : " bytes, in memory"));
      constexpr std::uint64_t kRows = 1000;
      RowFile file(kRows, bytes, spill);
      std::vector<std::byte> all;
      for (std::uint64_t first = 0, n = 1; first < kRows; first += n, n = std::min(n * 3, kRows - first)) {
        std::vector<std::byte> some;
        for (std::uint64_t row = first; row < first + n; ++row) {
          const auto r = record(row, bytes);
          some.insert(some.end(), r.begin(), r.end());
        }
        file.append(some);
        all.insert(all.end(), some.begin(), some.end());
      }
      EXPECT_EQ(file.record_bytes(), bytes);
      EXPECT_EQ(file.spilled_bytes(), spill != nullptr ? kRows * bytes : 0);
      for (const auto& [row, n] :
           {std::pair<std::uint64_t, std::uint64_t>{0, 1000}, {999, 1}, {500, 3}, {17, 400}, {3, 0}}) {
        std::vector<std::byte> read(n * bytes);
        file.read(row, read);
        const auto at = all.begin() + static_cast<std::ptrdiff_t>(row * bytes);
        EXPECT_EQ(read, std::vector<std::byte>(at, at + static_cast<std::ptrdiff_t>(n * bytes))) << row;
      }
    }
  }
}

}  // namespace
}  // namespace pointsweep
