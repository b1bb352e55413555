// SPDX-License-Identifier: MIT
#include "pointsweep/search/cell_search.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <span>

#include "pointsweep/search/cut.h"
#include "tests/support/brute_force.h"
#include "tests/support/fixed_seed.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

/// All points of a cloud as one slab, cut into cells.
struct Cells {
  CellDirectory directory;
  std::vector<std::unique_ptr<Cell>> cells;

  Cells(const std::vector<Vec3>& points, std::uint32_t cell_points) {
    std::vector<CutPoint> moved;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i] - points[0];
      moved.push_back({{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}, i});
    }
    std::vector<std::uint32_t> begin;
    cut(
        moved, cell_points, [](std::uint32_t i) { return i; }, begin);
    for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
      auto cell = std::make_unique<Cell>(begin[c + 1] - begin[c]);
      for (std::uint32_t j = 0; j < cell->size(); ++j) {
        const std::uint32_t from = moved[begin[c] + j].index;
        cell->x[j] = points[from].x, cell->y[j] = points[from].y, cell->z[j] = points[from].z, cell->row[j] = from;
      }
      cell->seal();
      directory.add(static_cast<std::uint32_t>(c), cell.get());
      cells.push_back(std::move(cell));
    }
  }

  std::vector<std::vector<std::uint32_t>> search(const Neighborhood& what) {
    std::size_t n = 0;
    for (const auto& cell : cells) n += cell->size();
    std::vector<std::vector<std::uint32_t>> lists(n);
    SearchScratch scratch;
    CellNeighbors found;
    for (std::uint32_t s = 0; s < cells.size(); ++s) {
      pointsweep::search({directory, s, what}, *cells[s], kAllLists, scratch, found);
      for (std::uint32_t i = 0; i < cells[s]->size(); ++i) {
        const Vec3 p = cells[s]->position(i);
        for (std::uint32_t j = found.begin[i]; j < found.begin[i + 1]; ++j) {
          const Cell& cell = directory.cell(slot_of(found.refs[j]));
          lists[cells[s]->row[i]].push_back(static_cast<std::uint32_t>(cell.row[index_of(found.refs[j])]));
          EXPECT_LE(distance2(cell.position(index_of(found.refs[j])), p), found.reach2[i]);
        }
      }
    }
    return lists;
  }
};

/// Returns the lists of points of a cell, by several searches. A search finds at most `most` neighbours, not counting
/// those of its last point.
CellNeighbors search_in_turns(const CellQuery& query, const CellSubset& points, std::uint64_t most) {
  SearchScratch scratch;
  CellNeighbors all, run;
  all.begin = {0};
  for (CellSubset rest = points; rest.size() > 0; rest = rest.from(run.size())) {
    const std::uint32_t found = search(query, rest, most, scratch, run);
    EXPECT_EQ(run.size(), found);
    EXPECT_EQ(run.reach2.size(), found);
    if (run.size() == 0) break;
    if (query.what.k > 64) {
      EXPECT_LT(run.begin[run.size() - 1], std::max<std::uint64_t>(most, 1)) << "no more than needed";
    }
    for (std::uint32_t i = 1; i < run.begin.size(); ++i)
      all.begin.push_back(static_cast<std::uint32_t>(all.refs.size()) + run.begin[i]);
    all.refs.insert(all.refs.end(), run.refs.begin(), run.refs.end());
    all.reach2.insert(all.reach2.end(), run.reach2.begin(), run.reach2.end());
  }
  return all;
}

using Shape = std::function<Vec3(std::mt19937_64&)>;

double uniform(std::mt19937_64& rng) { return std::uniform_real_distribution<double>(0, 1)(rng); }

std::vector<std::pair<std::string, Shape>> shapes() {
  return {
      {"plane",
       [](auto& r) {
         return Vec3{uniform(r), uniform(r), 0};
       }},
      {"volume",
       [](auto& r) {
         return Vec3{uniform(r), uniform(r), uniform(r)};
       }},
      {"line",
       [](auto& r) {
         const double t = uniform(r);
         return Vec3{t, 2 * t, -t};
       }},
      {"grid, full of ties",
       [](auto& r) {
         return Vec3{std::floor(9 * uniform(r)), std::floor(9 * uniform(r)), std::floor(9 * uniform(r))};
       }},
      {"one place",
       [](auto&) {
         return Vec3{1, 2, 3};
       }},
      {"few places and points between",
       [](auto& r) {
         return uniform(r) < 0.1 ? Vec3{3 * uniform(r), 0.1 * uniform(r), 0} : Vec3{std::floor(3 * uniform(r)), 0, 0};
       }},
      {"outliers",
       [](auto& r) {
         const double s = uniform(r) < 0.02 ? 1e6 : 1;
         return Vec3{s * uniform(r), s * uniform(r), uniform(r)};
       }},
      {"metres of a national grid in millimetres",
       [](auto& r) {
         return Vec3{5e6 + std::round(2e3 * uniform(r)) / 1e3, 4e6 + std::round(2e3 * uniform(r)) / 1e3, 100};
       }},
      {"huge",
       [](auto& r) {
         return Vec3{1e12 + uniform(r), 1e12 * uniform(r), uniform(r)};
       }},
      {"tiny",
       [](auto& r) {
         return Vec3{1e-12 * uniform(r), 1e-12 * uniform(r), 1e-13 * uniform(r)};
       }},
      {"squares that are denormal in single precision",
       [](auto& r) {
         return Vec3{1e-22 * uniform(r), 1e-22 * uniform(r), 1e-22 * uniform(r)};
       }},
      {"squares that are denormal in double precision",
       [](auto& r) {
         return Vec3{1e-160 * uniform(r), 1e-160 * uniform(r), 1e-160 * uniform(r)};
       }},
      {"denormal",
       [](auto& r) {
         return Vec3{1e-310 * uniform(r), 1e-310 * uniform(r), 0};
       }},
      {"near the end of double",
       [](auto& r) {
         return Vec3{1e154 * uniform(r), 1e154 * uniform(r), 0};
       }},
      {"a speck among far points",
       [](auto& r) {
         const double s = uniform(r) < 0.3 ? 1e-9 : 1e7;
         return Vec3{s * uniform(r), s * uniform(r), s * uniform(r)};
       }},
      {"density over six decades",
       [](auto& r) {
         const double s = std::pow(10, -6 * uniform(r));
         return Vec3{s * uniform(r), s * uniform(r), 0.1 * s * uniform(r)};
       }},
  };
}

using Lists = std::vector<std::vector<std::uint32_t>>;

/// Compares the lists of all points with the first `what.k` neighbours of `expected`, which may have more.
void expect_lists(const std::vector<Vec3>& points, const Lists& expected, const Neighborhood& what,
                  std::uint32_t cell_points) {
  const Lists found = Cells(points, cell_points).search(what);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::span<const std::uint32_t> first = std::span(expected[i]).first(std::min(what.k, expected[i].size()));
    ASSERT_TRUE(std::ranges::equal(found[i], first)) << "point " << i;
  }
}

void expect_equal_to_brute_force(const std::vector<Vec3>& points, const Neighborhood& what, std::uint32_t cell_points) {
  expect_lists(points, brute_force_neighbors(points, what.k, what.radius), what, cell_points);
}

std::vector<Vec3> points_of(const Shape& shape, std::size_t n, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::vector<Vec3> points(n);
  for (Vec3& p : points) p = shape(rng);
  return points;
}

TEST(CellSearch, EqualsBruteForceOnEveryShapeForSmallAndLargeK) {
  for (const auto& [name, shape] : shapes()) {
    const std::vector<Vec3> points = points_of(shape, sized(500), 42);
    const Lists expected = brute_force_neighbors(points, 600);
    for (const std::size_t k : {1, 5, 8, 13, 16, 24, 32, 64, 65, 200, 600}) {
      SCOPED_TRACE(name + ", k = " + std::to_string(k));
      expect_lists(points, expected, {.k = k}, 256);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(CellSearch, EqualsBruteForceForTinyCellsAndFewPoints) {
  for (const auto& [name, shape] : shapes()) {
    for (const std::size_t n : {1, 2, 8, 9, 10, 17, 33, 100}) {
      for (const std::size_t k : {1, 8, 9, 40}) {
        SCOPED_TRACE(name + ", n = " + std::to_string(n) + ", k = " + std::to_string(k));
        std::mt19937_64 rng(n);
        std::vector<Vec3> points(n);
        for (Vec3& p : points) p = shape(rng);
        expect_equal_to_brute_force(points, {.k = k}, 16);
        if (HasFatalFailure()) return;
      }
    }
  }
}

TEST(CellSearch, SearchesPlainlyWhereTooManyPointsLieAroundALeaf) {
  std::vector<Vec3> points(50'000);
  std::mt19937_64 rng(3);
  for (std::size_t i = 0; i < points.size(); i += 100) points[i] = {uniform(rng), uniform(rng), uniform(rng)};
  Cells cells(points, 1024);
  const Neighborhood what{.k = 100};
  SearchScratch scratch;
  CellNeighbors found, expected;
  for (std::uint32_t s = 0; s < cells.cells.size(); ++s) {
    const CellQuery query{cells.directory, s, what};
    search(query, query.cell(), kAllLists, scratch, found);
    expected.begin.assign(1, 0), expected.refs.clear(), expected.reach2.clear();
    search_plainly(query, query.cell(), kAllLists, scratch, expected);
    ASSERT_EQ(found.refs, expected.refs);
    ASSERT_EQ(found.begin, expected.begin);
    ASSERT_EQ(found.reach2, expected.reach2);
  }
}

TEST(CellSearch, HonoursTheRadiusInclusively) {
  for (const auto& [name, shape] : shapes()) {
    const std::vector<Vec3> points = points_of(shape, sized(400), 7);
    for (const double radius : {0.0, 1e-3, 0.05, 1.0, 2.0, 1e6}) {
      const Lists expected = brute_force_neighbors(points, Neighborhood::kUnlimited, radius);
      for (const std::size_t k : {std::size_t{8}, std::size_t{40}, Neighborhood::kUnlimited}) {
        SCOPED_TRACE(name + ", radius " + std::to_string(radius) + ", k = " + std::to_string(k));
        expect_lists(points, expected, {.k = k, .radius = radius}, 64);
        if (HasFatalFailure()) return;
      }
    }
  }
}

/// Generates a point on a coarse grid of varying step: ties, duplicates and jumps in density.
rc::Gen<Vec3> rough_point() {
  const auto coordinate = rc::gen::map(rc::gen::pair(rc::gen::inRange(-6, 7), rc::gen::element(1.0, 0.5, 1e-3, 1e3)),
                                       [](const std::pair<int, double>& c) { return c.first * c.second; });
  return rc::gen::map(rc::gen::tuple(coordinate, coordinate, coordinate), [](const auto& c) {
    return Vec3{std::get<0>(c), std::get<1>(c), std::get<2>(c)};
  });
}

TEST(CellSearch, EqualsBruteForceForAnyPointsKRadiusAndCells) {
  EXPECT_TRUE(rc::check("neighbours of any cloud", [] {
    const auto points = *rc::gen::resize(200, rc::gen::nonEmpty(rc::gen::container<std::vector<Vec3>>(rough_point())));
    const auto k = static_cast<std::size_t>(*rc::gen::inRange(1, 140));
    const double radius = *rc::gen::element(std::numeric_limits<double>::infinity(), 0.0, 0.5, 3.0, 1e3);
    const auto cell_points = static_cast<std::uint32_t>(16 * *rc::gen::inRange(1, 20));
    RC_ASSERT(Cells(points, cell_points).search({.k = k, .radius = radius}) ==
              brute_force_neighbors(points, k, radius));
  }));
}

TEST(CellSearch, RunsOfPointsHaveTheListsOfTheWholeCell) {
  std::mt19937_64 rng(11);
  for (const auto& [name, shape] : shapes()) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < sized(700); ++i) points.push_back(shape(rng));
    Cells cells(points, 512);
    double far = 0;
    for (const Vec3& p : points) far = std::max(far, length(p - points[0]));
    for (const Neighborhood& what :
         {Neighborhood{.k = Neighborhood::kUnlimited, .radius = far / 3}, Neighborhood{.k = 100, .radius = far / 3},
          Neighborhood{.k = 8}, Neighborhood{.k = 100}, Neighborhood{.k = 2000}}) {
      SearchScratch scratch;
      CellNeighbors whole;
      const CellQuery query{cells.directory, 0, what};
      search(query, query.cell(), kAllLists, scratch, whole);
      for (const std::uint64_t most : {1, 300, 20'000}) {
        SCOPED_TRACE(name + ", k " + std::to_string(what.k) + ", runs of " + std::to_string(most));
        const CellNeighbors runs = search_in_turns(query, query.cell(), most);
        ASSERT_EQ(runs.begin, whole.begin);
        ASSERT_EQ(runs.refs, whole.refs);
        ASSERT_EQ(runs.reach2.size(), whole.reach2.size());
      }
    }
  }
}

TEST(CellSearch, SomePointsOfACellHaveTheListsTheyHaveInTheWholeCell) {
  std::mt19937_64 rng(13);
  for (const auto& [name, shape] : shapes()) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < sized(700); ++i) points.push_back(shape(rng));
    Cells cells(points, 512);
    double far = 0;
    for (const Vec3& p : points) far = std::max(far, length(p - points[0]));
    for (const Neighborhood& what :
         {Neighborhood{.k = Neighborhood::kUnlimited, .radius = far / 3}, Neighborhood{.k = 100, .radius = far / 3},
          Neighborhood{.k = 8}, Neighborhood{.k = 40}, Neighborhood{.k = 100}, Neighborhood{.k = 2000}}) {
      SearchScratch scratch;
      CellNeighbors whole;
      const CellQuery query{cells.directory, 0, what};
      search(query, query.cell(), kAllLists, scratch, whole);
      for (const double share : {0.01, 0.3, 0.9, 1.0}) {
        for (const std::uint64_t most : {1, 20'000}) {
          if (share > 0.5 && most == 1) continue;  // the test RunsOfPoints checks single lists of most points
          SCOPED_TRACE(name + ", k " + std::to_string(what.k) + ", share " + std::to_string(share));
          std::vector<std::uint32_t> chosen = {3};
          for (std::uint32_t i = 4; i < whole.size(); ++i)
            if (uniform(rng) <= share) chosen.push_back(i);
          const CellNeighbors some = search_in_turns(query, chosen, most);
          ASSERT_EQ(some.size(), chosen.size());
          for (std::uint32_t n = 0; n < chosen.size(); ++n) {
            const std::uint32_t i = chosen[n];
            ASSERT_EQ(std::vector(some.refs.begin() + some.begin[n], some.refs.begin() + some.begin[n + 1]),
                      std::vector(whole.refs.begin() + whole.begin[i], whole.refs.begin() + whole.begin[i + 1]));
            if (some.begin[n + 1] > some.begin[n]) {
              const NeighborRef last = some.refs[some.begin[n + 1] - 1];
              const Vec3 p = cells.directory.cell(0).position(i);
              ASSERT_LE(distance2(cells.directory.cell(slot_of(last)).position(index_of(last)), p), some.reach2[n]);
            }
          }
        }
      }
    }
  }
}

/// The lists are so long that they are sorted in parts of parts.
TEST(CellSearch, LongListsEqualBruteForce) {
  std::mt19937_64 rng(17);
  for (const auto& [name, shape] : shapes()) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < 6000; ++i) points.push_back(shape(rng));
    double far = 0;
    for (const Vec3& p : points) far = std::max(far, length(p - points[0]));
    Cells cells(points, 1024);
    const std::vector<std::uint32_t> chosen = {0, 7, 400, 401};
    SearchScratch scratch;
    CellNeighbors found;
    for (const Neighborhood& what :
         {Neighborhood{.k = 129}, Neighborhood{.k = 1000}, Neighborhood{.k = 5000},
          Neighborhood{.k = Neighborhood::kUnlimited, .radius = far / 3}, Neighborhood{.k = 2000, .radius = far / 2}}) {
      SCOPED_TRACE(name + ", k " + std::to_string(what.k));
      search({cells.directory, 1, what}, chosen, kAllLists, scratch, found);
      ASSERT_EQ(found.size(), chosen.size());
      for (std::size_t n = 0; n < chosen.size(); ++n) {
        const auto row = static_cast<std::uint32_t>(cells.directory.cell(1).row[chosen[n]]);
        std::vector<std::uint32_t> rows;
        for (std::uint32_t j = found.begin[n]; j < found.begin[n + 1]; ++j) {
          const NeighborRef ref = found.refs[j];
          rows.push_back(static_cast<std::uint32_t>(cells.directory.cell(slot_of(ref)).row[index_of(ref)]));
        }
        const std::size_t most = std::min(what.k, points.size());
        ASSERT_EQ(rows, brute_force_neighbors_of(points, row, most, what.radius)) << "point " << chosen[n];
      }
    }
  }
}

TEST(CellSearch, ARadiusThatHoldsMoreThanIsGatheredGivesTheSameLists) {
  for (const auto& [name, shape] : shapes()) {
    if (name != "volume" && name != "grid, full of ties" && name != "few places and points between") continue;
    std::mt19937_64 rng(12);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < 40'000; ++i) points.push_back(shape(rng));  // more than 32,768
    Cells cells(points, 1024);
    SearchScratch scratch;
    CellNeighbors found;
    const Cell& cell = cells.directory.cell(3);
    const Neighborhood what{.k = Neighborhood::kUnlimited, .radius = 20};
    search({cells.directory, 3, what}, CellSubset(5, cell.size()), 1, scratch, found);
    ASSERT_EQ(found.size(), 1u) << name;
    const auto row = static_cast<std::uint32_t>(cell.row[5]);
    std::vector<std::uint32_t> rows;
    for (const NeighborRef ref : found.refs)
      rows.push_back(static_cast<std::uint32_t>(cells.directory.cell(slot_of(ref)).row[index_of(ref)]));
    EXPECT_EQ(rows, brute_force_neighbors_of(points, row, points.size(), 20)) << name;
  }
}

}  // namespace
}  // namespace pointsweep
