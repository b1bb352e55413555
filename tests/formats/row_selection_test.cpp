// SPDX-License-Identifier: MIT
#include "pointsweep/formats/cloud/row_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

namespace pointsweep {
namespace {

/// A selection of the rows for which `bits` is true, and the numbers of these rows.
struct Selected {
  std::vector<bool> bits;
  RowSelection selection;
  std::vector<std::uint32_t> rows;

  explicit Selected(std::vector<bool> keep)
      : bits(std::move(keep)), selection(bits.size(), [this](std::uint64_t block, std::span<std::byte> out) {
          std::fill(out.begin(), out.end(), std::byte{0});
          for (std::size_t i = 0; i < RowSelection::kBlockRows && block * RowSelection::kBlockRows + i < bits.size();
               ++i)
            if (bits[block * RowSelection::kBlockRows + i]) out[i / 8] |= std::byte{1} << i % 8;
        }) {
    for (std::uint32_t i = 0; i < bits.size(); ++i)
      if (bits[i]) rows.push_back(i);
  }

  /// Reads selected records, which are the numbers of their rows.
  std::vector<std::uint32_t> read(std::uint64_t first, std::size_t most) {
    std::vector<std::uint32_t> records(most);
    const std::size_t n = SelectionCursor(selection).read(first, 4, std::as_writable_bytes(std::span(records)),
                                                          [&](std::uint64_t row, std::span<std::byte> out) {
                                                            ASSERT_LE(row + out.size() / 4, bits.size());
                                                            for (std::size_t i = 0; i < out.size(); i += 4, ++row) {
                                                              const auto number = static_cast<std::uint32_t>(row);
                                                              std::memcpy(out.data() + i, &number, 4);
                                                            }
                                                          });
    records.resize(n);
    return records;
  }
};

std::vector<Selected> selections() {
  std::mt19937_64 random(1);
  std::vector<std::vector<bool>> all = {
      {}, std::vector<bool>(5, false), std::vector<bool>(4096, true), std::vector<bool>(20000, true)};
  for (const unsigned of : {2u, 50u, 5000u}) {
    std::vector<bool> some(30001);
    for (std::size_t i = 0; i < some.size(); ++i) some[i] = random() % of == 0 || (i > 9000 && i < 22000);
    all.push_back(some);
  }
  std::vector<Selected> out;
  out.reserve(all.size());
  for (auto& bits : all) out.emplace_back(std::move(bits));
  return out;
}

TEST(RowSelection, ReadsTheKeptRowsFromAnyPlace) {
  for (Selected& s : selections()) {
    ASSERT_EQ(s.selection.count(), s.rows.size());
    for (const std::size_t most : {1u, 7u, 4096u, 50000u}) {
      for (std::size_t first = 0; first <= s.rows.size() + 3; first += 1 + s.rows.size() / 13) {
        const std::size_t end = std::min(first + most, s.rows.size());
        const std::vector<std::uint32_t> expected(s.rows.begin() + static_cast<std::ptrdiff_t>(std::min(first, end)),
                                                  s.rows.begin() + static_cast<std::ptrdiff_t>(end));
        ASSERT_EQ(s.read(first, most), expected);
      }
    }
  }
}

TEST(RowSelection, KnowsTheNumberOfEveryKeptRow) {
  for (Selected& s : selections()) {
    SelectionCursor kept(s.selection);
    for (std::size_t i = 0; i < s.rows.size(); i += 1 + s.rows.size() / 100) EXPECT_EQ(kept.row_of(i), s.rows[i]);
    for (std::size_t row = 0; row < s.bits.size(); row += 1 + s.bits.size() / 100) {
      EXPECT_EQ(kept.has(row), s.bits[row]);
      const auto here = s.bits.begin() + static_cast<std::ptrdiff_t>(row);
      EXPECT_EQ(kept.kept_before(row), static_cast<std::uint64_t>(std::count(s.bits.begin(), here, true)));
    }
    EXPECT_EQ(kept.kept_before(s.bits.size()), s.rows.size());
  }
}

/// Rows outside of the requested range may be in a chunk that another thread decodes.
TEST(RowSelection, ReadsNoRowBeforeTheFirstOrAfterTheLast) {
  for (Selected& s : selections()) {
    for (std::size_t first = 0; first < s.rows.size(); first += 1 + s.rows.size() / 13) {
      const std::size_t last = std::min(first + 777, s.rows.size()) - 1;
      std::vector<std::byte> records(4 * (last - first + 1));
      SelectionCursor(s.selection).read(first, 4, records, [&](std::uint64_t row, std::span<std::byte> out) {
        EXPECT_GE(row, s.rows[first]);
        EXPECT_LE(row + out.size() / 4, s.rows[last] + std::uint64_t{1});
      });
    }
  }
}

}  // namespace
}  // namespace pointsweep
