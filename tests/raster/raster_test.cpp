// SPDX-License-Identifier: MIT
/// Filters that stream rows of cells, against loops over whole rasters.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/raster/cells.h"
#include "pointsweep/raster/ground_surface.h"
#include "pointsweep/raster/row_filters.h"
#include "pointsweep/threads.h"
#include "tests/support/scratch_in_memory.h"

namespace pointsweep {
namespace {

/// Makes scratches in memory, and counts them.
struct Scratches {
  std::size_t made = 0;
  MakeScratch make() {
    return [this]() -> std::unique_ptr<Scratch> {
      ++made;
      return std::make_unique<ScratchInMemory>();
    };
  }
};

struct Raster {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;
  std::vector<std::uint8_t> marks;

  double at(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
  bool operator==(const Raster&) const = default;
};

/// A stream of the rows of a raster, `at_once` rows at a time.
class RasterRows final : public RowStream {
 public:
  RasterRows(const Raster& raster, std::size_t at_once)
      : RowStream(raster.columns), raster_(raster), at_once_(at_once) {}
  bool next(CellRows& out) override {
    out.rows = std::min(at_once_, raster_.rows - row_);
    const auto first = static_cast<std::ptrdiff_t>(row_ * columns());
    const auto cells = static_cast<std::ptrdiff_t>(out.rows * columns());
    out.values.assign(raster_.values.begin() + first, raster_.values.begin() + first + cells);
    out.marks.assign(raster_.marks.begin() + first, raster_.marks.begin() + first + cells);
    row_ += out.rows;
    return out.rows > 0;
  }

 private:
  const Raster& raster_;
  std::size_t at_once_, row_ = 0;
};

Raster all_of(RowStream& stream) {
  Raster raster{.rows = 0, .columns = stream.columns(), .values = {}, .marks = {}};
  for (CellRows rows; stream.next(rows);) {
    raster.rows += rows.rows;
    raster.values.insert(raster.values.end(), rows.values.begin(), rows.values.end());
    raster.marks.insert(raster.marks.end(), rows.marks.begin(), rows.marks.end());
  }
  return raster;
}

/// Returns a random raster. `absent` of ten cells have no value; a tenth of the cells is marked.
Raster random_raster(std::size_t rows, std::size_t columns, unsigned absent, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Raster raster{rows, columns, {}, {}};
  for (std::size_t i = 0; i < rows * columns; ++i) {
    const double value = static_cast<double>(random() % 1000) / 8 - 60;
    raster.values.push_back(random() % 10 < absent ? kNoCell : value);
    raster.marks.push_back(random() % 10 == 0);
  }
  return raster;
}

/// Returns the least or greatest value over the disk around each cell.
std::vector<double> over_disks(const Raster& raster, const std::vector<double>& values, int radius, bool least) {
  std::vector<double> result(values.size(), kNoCell);
  const int rows = static_cast<int>(raster.rows), columns = static_cast<int>(raster.columns);
  const auto index = [&](int row, int column) { return static_cast<std::size_t>(row * columns + column); };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      if (values[index(row, column)] == kNoCell) continue;
      double& best = result[index(row, column)] = values[index(row, column)];
      for (int r = std::max(0, row - radius); r <= std::min(rows - 1, row + radius); ++r)
        for (int c = std::max(0, column - radius); c <= std::min(columns - 1, column + radius); ++c) {
          const double value = values[index(r, c)];
          if ((r - row) * (r - row) + (c - column) * (c - column) > radius * radius || value == kNoCell) continue;
          best = least ? std::min(best, value) : std::max(best, value);
        }
    }
  return result;
}

Raster opened(const Raster& raster, int radius, double threshold, bool pits) {
  std::vector<double> turned = raster.values;
  for (double& value : turned)
    if (pits && value != kNoCell) value = -value;
  const std::vector<double> low = over_disks(raster, over_disks(raster, turned, radius, true), radius, false);
  Raster result = raster;
  for (std::size_t i = 0; i < low.size(); ++i) {
    if (turned[i] == kNoCell) continue;
    if (turned[i] - low[i] > threshold) result.marks[i] = 1;
    if (!pits) result.values[i] = low[i];
  }
  return result;
}

TEST(OpenedRows, AreThoseOfTheWholeRaster) {
  std::uint64_t seed = 1;
  for (const auto& [rows, columns] : {std::pair{1u, 1u}, {1u, 40u}, {40u, 1u}, {3u, 700u}, {90u, 37u}, {33u, 1100u}})
    for (const int radius : {0, 1, 2, 3, 5, 12}) {
      ++seed;
      const Raster raster = random_raster(rows, columns, static_cast<unsigned>(seed % 10), seed);
      for (const Opens opens : {Opens::surface, Opens::pit_marks})
        for (const std::size_t at_once : {1u, 16u, 1000u}) {
          OpenedRows stream(std::make_unique<RasterRows>(raster, at_once), static_cast<std::size_t>(radius), 20, opens);
          EXPECT_TRUE(all_of(stream) == opened(raster, radius, 20, opens == Opens::pit_marks))
              << rows << " x " << columns << ", radius " << radius;
        }
    }
}

/// Fills holes from the nearest known cell on each side, found step by step.
Raster filled(const Raster& raster, int reach) {
  Raster result = raster;
  const int rows = static_cast<int>(raster.rows), columns = static_cast<int>(raster.columns);
  const auto known = [&](int row, int column) {
    if (row < 0 || column < 0 || row >= rows || column >= columns) return kNoCell;
    const auto i = static_cast<std::size_t>(row * columns + column);
    return raster.marks[i] != 0 ? kNoCell : raster.values[i];
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const auto i = static_cast<std::size_t>(row * columns + column);
      result.marks[i] = 0;
      result.values[i] = known(row, column);
      if (result.values[i] != kNoCell) continue;
      const auto side = [&](int dr, int dc) {
        for (int d = 1; d <= reach; ++d)
          if (const double value = known(row + d * dr, column + d * dc); value != kNoCell)
            return std::pair(value / d, 1.0 / d);
        return std::pair(0.0, 0.0);
      };
      const auto [w, ww] = side(0, -1);
      const auto [e, we] = side(0, 1);
      const auto [s, ws] = side(-1, 0);
      const auto [n, wn] = side(1, 0);
      const double weight = (ww + we) + (ws + wn);
      if (weight > 0) result.values[i] = ((w + e) + (s + n)) / weight;
    }
  return result;
}

TEST(FilledRows, AreThoseOfTheWholeRaster) {
  std::uint64_t seed = 100;
  for (const auto& [rows, columns] : {std::pair{1u, 1u}, {1u, 60u}, {60u, 1u}, {130u, 37u}, {40u, 1100u}})
    for (const int reach : {1, 2, 7, 40})
      for (const unsigned absent : {0u, 5u, 9u, 10u}) {
        const Raster raster = random_raster(rows, columns, absent, ++seed);
        for (const std::size_t at_once : {1u, 16u, 1000u}) {
          FilledRows stream(std::make_unique<RasterRows>(raster, at_once), static_cast<std::size_t>(reach));
          EXPECT_TRUE(all_of(stream) == filled(raster, reach)) << rows << " x " << columns << ", reach " << reach;
        }
      }
}

/// Adds the cells of two islands, row by row. `far` is added to the rows and columns of the second island.
void add_islands(LowestCells& cells, double far) {
  std::mt19937_64 random(7);
  std::set<std::pair<double, double>> places;
  for (int i = 0; i < 1500; ++i) {
    const double row = static_cast<double>(random() % 40), column = static_cast<double>(random() % 60);
    places.insert({row, column});
    if (i % 2 == 0) places.insert({row + far, column + far});
  }
  for (const auto& [row, column] : places) {
    const double own_row = row >= far ? row - far : row, own_column = column >= far ? column - far : column;
    const auto place = static_cast<std::uint64_t>(own_row * 100 + own_column);
    cells.add(row - 1e6, column - 3, static_cast<double>(place * 7919 % 257));
    cells.add(row - 1e6, column - 3, static_cast<double>(place * 7919 % 257) + 5);
  }
  cells.finish();
}

/// Returns the surface at the cells that have a point, row by row.
std::vector<double> surface_of(const LowestCells& cells, const GroundRule& rule, std::uint64_t memory,
                               Scratches& made) {
  std::vector<double> values;
  for (std::size_t b = 0; b < cells.bands(); ++b) {
    const CellBand band(cells, b);
    const std::unique_ptr<RowStream> surface = ground_surface(band, rule, memory, made.make());
    const Raster raster = all_of(*surface);
    EXPECT_EQ(raster.rows, band.rows());
    std::vector<LowestCell> some;
    for (std::uint64_t first = 0; first < band.count(); first += some.size()) {
      band.read(first, some);
      for (const LowestCell& cell : some)
        values.push_back(raster.at(static_cast<std::size_t>(cell.row), band.columns().place_of(cell.column)));
    }
  }
  return values;
}

/// Returns the number of cells of all bands, including empty cells.
std::uint64_t all_cells(const LowestCells& cells) {
  std::uint64_t all = 0;
  for (std::size_t b = 0; b < cells.bands(); ++b) {
    const CellBand band(cells, b);
    all += band.rows() * band.columns().size();
  }
  return all;
}

LowestCells islands(const GroundRule& rule, double far) {
  LowestCells cells(rule.axis_rule(), std::make_unique<ScratchInMemory>());
  add_islands(cells, far);
  return cells;
}

TEST(GroundSurface, DoesNotDependOnMemory) {
  const GroundRule rule{.cell = 1, .slope = 2, .radius = 6};
  const LowestCells cells = islands(rule, 1000);
  const std::uint64_t least = least_ground_bytes(rule, cells.most_columns());
  Scratches all, few;
  const std::vector<double> expected = surface_of(cells, rule, 1u << 30, all);
  EXPECT_EQ(all.made, 0u);
  EXPECT_EQ(surface_of(cells, rule, least, few), expected);
  EXPECT_GE(few.made, 2u);
  EXPECT_THROW(surface_of(cells, rule, least - 1, few), Error);
}

TEST(GroundSurface, DoesNotDependOnThreads) {
  const GroundRule rule{.cell = 1, .slope = 2, .radius = 6};
  const LowestCells cells = islands(rule, 70);
  std::vector<std::vector<double>> surfaces;
  for (const unsigned threads : {1u, 2u, 5u})
    with_threads(threads, [&] {
      Scratches made;
      surfaces.push_back(surface_of(cells, rule, 1u << 30, made));
    });
  EXPECT_EQ(surfaces[1], surfaces[0]);
  EXPECT_EQ(surfaces[2], surfaces[0]);
}

/// Islands beyond the reach of the filters change nothing, wherever they are, and do not enlarge the raster.
TEST(GroundSurface, DoesNotDependOnWhatIsFarAway) {
  const GroundRule rule{.cell = 1, .slope = 2, .radius = 3};
  const double apart = 39 + static_cast<double>(rule.axis_rule().most);  // the first island has rows 0 to 39
  Scratches made;
  const LowestCells together = islands(rule, apart - 1), close = islands(rule, apart);
  EXPECT_EQ(together.bands(), 1u);
  const std::vector<double> expected = surface_of(together, rule, 1u << 30, made);
  for (const double far : {apart, 1e4, 1e7, 1e12}) {
    const LowestCells cells = islands(rule, far);
    EXPECT_EQ(cells.bands(), 2u);
    EXPECT_EQ(surface_of(cells, rule, 1u << 30, made), expected) << far;
    EXPECT_LE(all_cells(cells), all_cells(close));
  }
}

/// A band whose heights vary less than the lowest object: filled minima without filters give the surface of the
/// filters.
TEST(GroundSurface, OfALevelBandIsThatOfTheFilters) {
  const GroundRule filters{.cell = 1, .slope = 2, .radius = 6};
  std::mt19937_64 random(5);
  LowestCells cells(filters.axis_rule(), std::make_unique<ScratchInMemory>());
  LowestCells steep(filters.axis_rule(), std::make_unique<ScratchInMemory>());
  for (int i = 0; i < 900; ++i) {
    if (random() % 3 == 0) continue;
    const double z = 0.9 * static_cast<double>(random() % 1000) / 1000;
    cells.add(i / 30, i % 30, z);
    steep.add(i / 30, i % 30, z);
  }
  cells.finish();
  steep.add(29, 30, 1.9);  // too much relief to skip the filters, too little for an object
  steep.finish();
  Scratches made;
  EXPECT_LT(CellBand(cells, 0).height(), filters.least_height());
  EXPECT_GT(CellBand(steep, 0).height(), filters.least_height());
  const std::vector<double> surface = surface_of(cells, filters, 1u << 30, made);
  const std::vector<double> by_filters = surface_of(steep, filters, 1u << 30, made);
  EXPECT_EQ(surface, std::vector<double>(by_filters.begin(), by_filters.end() - 1));
}

/// Single cells lie along a diagonal, each far from the others.
TEST(GroundSurface, EmptyRangesBetweenIslandsAreNoCells) {
  const GroundRule rule{.cell = 1, .slope = 2, .radius = 3};
  LowestCells cells(rule.axis_rule(), std::make_unique<ScratchInMemory>());
  constexpr int kIslands = 1000;
  for (int i = 0; i < kIslands; ++i) cells.add(1000.0 * i, 500.0 * i, i % 7);
  cells.finish();
  const std::size_t side = 2 * rule.axis_rule().margin + 1;
  EXPECT_EQ(all_cells(cells), kIslands * side * side);
}

TEST(CellAxis, PlacesNumbersInAnyOrderAsInAscendingOrder) {
  std::mt19937_64 random(3);
  std::vector<double> numbers;
  for (int i = 0; i < 200'000; ++i)
    numbers.push_back(static_cast<double>(random() % 3000) * (random() % 50 == 0 ? 1e6 : 1) - 1500);
  CellAxis axis({.margin = 4, .most = 9});
  for (const double number : numbers) axis.add(number);
  axis.finish();
  std::ranges::sort(numbers);
  double before = numbers.front();
  std::size_t place = 4;
  for (const double number : numbers) {
    place += static_cast<std::size_t>(std::min(number - std::exchange(before, number), 9.0));
    ASSERT_EQ(axis.place_of(number), place) << number;
  }
  EXPECT_EQ(axis.size(), place + 4 + 1);
}

TEST(BandedRows, BeginWithTheirMarginAfterAWideGap) {
  BandedRows rows({.margin = 4, .most = 9});
  EXPECT_EQ(rows.rows(), 0u);
  const std::vector<std::array<double, 3>> expected = {{-7, 0, 4}, {-7, 0, 4},  {1, 0, 12},
                                                       {10, 1, 4}, {18, 1, 12}, {1e9, 2, 4}};
  for (const auto& [number, band, place] : expected) {
    EXPECT_EQ(static_cast<double>(rows.place_of(number)), place) << number;
    EXPECT_EQ(static_cast<double>(rows.band()), band) << number;
    EXPECT_EQ(static_cast<double>(rows.rows()), place + 5) << number;
  }
}

TEST(SurfaceWindow, HoldsTheRowsAroundARow) {
  const Raster raster = random_raster(100, 5, 3, 9);
  SurfaceWindow window(std::make_unique<RasterRows>(raster, 16), 2);
  for (const std::uint64_t row : {3u, 3u, 4u, 17u, 60u, 61u, 97u, 99u}) {
    window.move_to(row);
    for (std::uint64_t r = row - 2; r <= row + 2; ++r)
      for (std::size_t c = 0; c < 5; ++c)
        EXPECT_EQ(window.at(r, c), r < 100 ? raster.at(static_cast<std::size_t>(r), c) : kNoCell) << row;
    EXPECT_EQ(window.at(row, 5), kNoCell);
  }
}

}  // namespace
}  // namespace pointsweep
