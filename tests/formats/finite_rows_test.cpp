// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {
namespace {

using Rows = std::vector<std::array<float, 3>>;

/// Returns n points (i, 0, 0), of which about the share `share` has no finite coordinates.
Rows rows_with_gaps(std::size_t n, double share, std::mt19937& random) {
  Rows rows;
  std::uniform_real_distribution<double> uniform;
  for (std::size_t i = 0; i < n; ++i) {
    rows.push_back({static_cast<float>(i), 0, 0});
    if (uniform(random) < share)
      rows.back()[random() % 3] = random() % 2 == 0 ? std::nanf("") : std::numeric_limits<float>::infinity();
  }
  return rows;
}

Rows finite_ones(const Rows& rows) {
  Rows out;
  for (const auto& row : rows)
    if (std::isfinite(row[0]) && std::isfinite(row[1]) && std::isfinite(row[2])) out.push_back(row);
  return out;
}

std::unique_ptr<Reader> reader_of(const Rows& rows) {
  return std::make_unique<ArrayReader>(std::span(rows.empty() ? nullptr : rows.front().data(), 3 * rows.size()));
}

Rows read(InputCloud& cloud, std::uint64_t first, std::size_t n) {
  Rows rows(n);
  rows.resize(cloud.read(first, std::as_writable_bytes(std::span(rows))));
  return rows;
}

TEST(FiniteRows, AreThoseOfAllInputsInAnyPieceAndNothingElse) {
  std::mt19937 random(1);
  for (const double share : {0.0, 0.0002, 0.01, 0.5, 0.999, 1.0}) {
    const Rows a = rows_with_gaps(9000, share, random), b = rows_with_gaps(4096, share / 2, random),
               c = rows_with_gaps(17, share, random);
    std::vector<std::unique_ptr<Reader>> readers;
    for (const Rows* rows : {&a, &b, &c}) readers.push_back(reader_of(*rows));
    InputCloud all(std::move(readers));
    Rows expected;
    for (const Rows* rows : {&a, &b, &c})
      for (const auto& row : finite_ones(*rows)) expected.push_back(row);
    auto [cloud, found] = all.finite();
    EXPECT_EQ(found.count, a.size() + b.size() + c.size() - expected.size());
    EXPECT_EQ(cloud.count(), expected.size());
    EXPECT_EQ(read(cloud, 0, 20000), expected);
    for (int piece = 0; piece < 200 && !expected.empty(); ++piece) {
      const std::size_t first = random() % expected.size(), n = random() % (piece % 2 == 0 ? 20 : 6000);
      const std::size_t last = std::min(expected.size(), first + n);
      EXPECT_EQ(read(cloud, first, n), Rows(expected.begin() + first, expected.begin() + last)) << first << " " << n;
    }
    EXPECT_EQ(all.count(), a.size() + b.size() + c.size());
    EXPECT_EQ(std::memcmp(read(all, 9000, 1).data(), b.data(), sizeof b[0]), 0);
  }
}

TEST(FiniteRows, HaveTheirPlacesInTheInputWhicheverReaderHasTheirRecords) {
  const float nan = std::nanf("");
  const Rows a = {{nan, 9, 9}, {1, 2, 3}}, b = {{4, nan, 0}, {5, nan, 0}, {-1, 5, 2}};
  std::vector<std::unique_ptr<Reader>> readers;
  for (const Rows* rows : {&a, &b}) readers.push_back(reader_of(*rows));
  const auto [finite, found] = InputCloud(std::move(readers)).finite();
  std::vector<std::shared_ptr<Reader>> others;
  const Rows finite_of_a = finite_ones(a), finite_of_b = finite_ones(b);
  for (const Rows* rows : {&finite_of_a, &finite_of_b}) others.push_back(reader_of(*rows));
  InputCloud decoded = finite.read_by(others);
  EXPECT_EQ(decoded.place_of_row(1), (std::pair<std::size_t, std::uint64_t>{1, 2}));
}

TEST(FiniteRows, TheOthersAreCountedWithTheBoundsOfTheRest) {
  const float nan = std::nanf("");
  const Rows rows = {{nan, 9, 9}, {1, 2, 3}, {4, nan, 0}, {-1, 5, 2}};
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(reader_of(rows));
  const NonfiniteRows found = InputCloud(std::move(readers)).finite().second;
  EXPECT_EQ(found.rows, (std::vector<std::uint64_t>{0, 2}));
  EXPECT_EQ(found.bounds, (Box{{-1, 2, 2}, {1, 5, 3}}));
  EXPECT_EQ(found.first, "row 0 of array");
}

}  // namespace
}  // namespace pointsweep
