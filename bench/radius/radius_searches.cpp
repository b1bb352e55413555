// SPDX-License-Identifier: MIT
/// Searches within a radius, on one thread, in nanoseconds per neighbour found:
///   radius_searches [POINTS] [NEIGHBORS_PER_ROW]
/// Contenders: the search of this library (exact order, double precision), a grid of cells as wide as the radius, with
/// and without sorting, and nanoflann's radiusSearch, sorted and unsorted. All contenders get the points in one compact
/// order, and must find equal numbers of neighbours and equal sums of squared distances. Prints one JSON object per
/// line.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <nanoflann.hpp>
#include <numbers>
#include <numeric>
#include <random>

#include "pointsweep/search/cell_search.h"
#include "pointsweep/search/cut.h"

namespace pointsweep {
namespace {

/// Returns points on a wavy closed surface; coordinates are floats stored as doubles.
std::vector<Vec3> surface(std::size_t n) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> gauss;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 p{gauss(rng), gauss(rng), gauss(rng)};
    p = (1 / length(p)) * p;
    const double r = 1 + 0.1 * std::sin(9 * p.x) * std::sin(7 * p.y + 3 * p.z);
    const Vec3 q = r * p;
    points.push_back({static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)});
  }
  return points;
}

/// The results of a contender; all must agree.
struct Found {
  std::uint64_t neighbors = 0;
  double distances = 0;  ///< sum of squares
  double seconds = 0;
};

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// The cloud cut into cells. `ordered`: the points cell by cell, in which order the other contenders get them.
struct Cells {
  CellDirectory directory;
  std::vector<std::unique_ptr<Cell>> cells;
  std::vector<Vec3> ordered;

  explicit Cells(const std::vector<Vec3>& points) {
    std::vector<CutPoint> moved;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points[i];
      moved.push_back({{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}, i});
    }
    std::vector<std::uint32_t> begin;
    cut(
        moved, 1024, [](std::uint32_t i) { return i; }, begin);
    for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
      auto& cell = cells.emplace_back(std::make_unique<Cell>(begin[c + 1] - begin[c]));
      for (std::uint32_t j = 0; j < cell->size(); ++j) {
        const Vec3 p = points[moved[begin[c] + j].index];
        cell->x[j] = p.x, cell->y[j] = p.y, cell->z[j] = p.z, cell->row[j] = ordered.size();
        ordered.push_back(p);
      }
      cell->seal();
      directory.add(static_cast<std::uint32_t>(c), cell.get());
    }
  }

  /// Searches the neighbours of the first `queries` points of `ordered`.
  Found search(double radius, std::size_t queries) const {
    Found found;
    SearchScratch scratch;
    CellNeighbors lists;
    const Neighborhood what{.k = Neighborhood::kUnlimited, .radius = radius};
    const Stopwatch watch;
    for (std::uint32_t slot = 0; queries > 0; ++slot) {
      const Cell& cell = *cells[slot];
      pointsweep::search({directory, slot, what}, cell, kAllLists, scratch, lists);
      const auto wanted = static_cast<std::uint32_t>(std::min<std::size_t>(queries, cell.size()));
      for (std::uint32_t i = 0; i < wanted; ++i)
        for (std::uint32_t j = lists.begin[i]; j < lists.begin[i + 1]; ++j, ++found.neighbors) {
          const Cell& other = *cells[slot_of(lists.refs[j])];
          found.distances += distance2(other.position(index_of(lists.refs[j])), cell.position(i));
        }
      queries -= wanted;
    }
    found.seconds = watch.seconds();
    return found;
  }
};

/// Points sorted by the cells of a grid. Cells are as wide as the radius, so that a point has its neighbours in 27
/// cells.
class Grid {
 public:
  Grid(const std::vector<Vec3>& points, double radius) : points_(points), per_length_(1 / radius) {
    for (const Vec3& p : points) box_.include(p);
    for (std::size_t a = 0; a < 3; ++a)
      size_[a] = static_cast<std::size_t>(box_.extent()[static_cast<int>(a)] * per_length_) + 1;
    begin_.resize(size_[0] * size_[1] * size_[2] + 1);
    for (const Vec3& p : points) ++begin_[cell_of(p) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    order_.resize(points.size());
    std::vector<std::uint32_t> at(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t i = 0; i < points.size(); ++i) order_[at[cell_of(points[i])]++] = i;
    for (const std::uint32_t i : order_) sorted_.push_back(points[i]);
  }

  Found search(double radius, std::size_t queries, bool in_order) const {
    Found found;
    std::vector<std::pair<double, std::uint32_t>> list;
    const Stopwatch watch;
    for (std::uint32_t q = 0; q < queries; ++q) {
      list.clear();
      around(points_[q], [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end; ++i) {
          const double d2 = distance2(sorted_[i], points_[q]);
          if (d2 <= radius * radius && order_[i] != q) list.emplace_back(d2, order_[i]);
        }
      });
      if (in_order) std::sort(list.begin(), list.end());
      for (const auto& [d2, i] : list) found.distances += d2;
      found.neighbors += list.size();
    }
    found.seconds = watch.seconds();
    return found;
  }

 private:
  std::size_t along(Vec3 p, std::size_t a) const {
    const int axis = static_cast<int>(a);
    return std::min(static_cast<std::size_t>((p[axis] - box_.lo[axis]) * per_length_), size_[a] - 1);
  }
  std::size_t number(std::size_t x, std::size_t y, std::size_t z) const { return (x * size_[1] + y) * size_[2] + z; }
  std::size_t cell_of(Vec3 p) const { return number(along(p, 0), along(p, 1), along(p, 2)); }

  /// Calls use(begin, end) for the points of each run of cells along z around p.
  template <class Use>
  void around(Vec3 p, Use use) const {
    const auto low = [&](std::size_t a) { return along(p, a) - std::min<std::size_t>(along(p, a), 1); };
    const auto high = [&](std::size_t a) { return std::min(along(p, a) + 1, size_[a] - 1); };
    for (std::size_t x = low(0); x <= high(0); ++x)
      for (std::size_t y = low(1); y <= high(1); ++y)
        use(begin_[number(x, y, low(2))], begin_[number(x, y, high(2)) + 1]);
  }

  const std::vector<Vec3>& points_;
  double per_length_;
  Box box_;
  std::array<std::size_t, 3> size_{};
  std::vector<std::uint32_t> begin_, order_;
  std::vector<Vec3> sorted_;
};

struct Adaptor {
  const std::vector<Vec3>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>, Adaptor, 3, std::uint32_t>;

Found search(const Tree& tree, const std::vector<Vec3>& points, double radius, std::size_t queries, bool in_order) {
  Found found;
  nanoflann::SearchParams parameters;
  parameters.sorted = in_order;
  std::vector<std::pair<std::uint32_t, double>> list;
  // nanoflann finds points nearer than the radius; this library also points at the radius.
  const double limit = std::nextafter(radius * radius, 4 * radius * radius);
  const Stopwatch watch;
  for (std::size_t q = 0; q < queries; ++q) {
    const double p[3] = {points[q].x, points[q].y, points[q].z};
    tree.radiusSearch(p, limit, list, parameters);
    for (const auto& [i, d2] : list) found.distances += d2;
    found.neighbors += list.size() - 1;
  }
  found.seconds = watch.seconds();
  return found;
}

void print(const char* who, double wanted, double radius, const Found& found, const Found& expected) {
  if (found.neighbors != expected.neighbors ||
      std::abs(found.distances - expected.distances) > 1e-9 * expected.distances) {
    fmt::print(stderr, "radius_searches: {} finds {} neighbours, not {}\n", who, found.neighbors, expected.neighbors);
    std::exit(1);
  }
  fmt::print("{{\"contender\": \"{}\", \"wanted\": {}, \"radius\": {:.6g}, \"neighbors\": {}, \"ns\": {:.2f}}}\n", who,
             wanted, radius, found.neighbors, 1e9 * found.seconds / static_cast<double>(found.neighbors));
}

void compare(std::size_t points, double neighbors_per_row) {
  const Cells cells(surface(points));
  const Adaptor adaptor{cells.ordered};
  const Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  for (const double wanted : {24, 66, 262, 1051}) {
    const double area = 4 * std::numbers::pi * 1.1;  // approximate area of the wavy surface
    const double radius = std::sqrt(wanted * area / (std::numbers::pi * static_cast<double>(points)));
    const auto queries = std::min(points, static_cast<std::size_t>(neighbors_per_row / wanted) + 1);
    const Grid grid(cells.ordered, radius);
    const Found expected = grid.search(radius, queries, false);
    print("grid, unsorted", wanted, radius, expected, expected);
    print("grid, sorted", wanted, radius, grid.search(radius, queries, true), expected);
    print("nanoflann, unsorted", wanted, radius, search(tree, cells.ordered, radius, queries, false), expected);
    print("nanoflann, sorted", wanted, radius, search(tree, cells.ordered, radius, queries, true), expected);
    print("pointsweep", wanted, radius, cells.search(radius, queries), expected);
  }
}

}  // namespace
}  // namespace pointsweep

int main(int argc, char** argv) {
  const std::size_t points = argc > 1 ? std::stoull(argv[1]) : 1'000'000;
  pointsweep::compare(points, argc > 2 ? std::stod(argv[2]) : 5e7);
}
