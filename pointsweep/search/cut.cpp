// SPDX-License-Identifier: MIT
#include "pointsweep/search/cut.h"

#include <algorithm>
#include <cassert>

#include "pointsweep/neighborhood.h"
#include "pointsweep/search/cell.h"

namespace pointsweep {
namespace {

struct Extent {
  std::array<float, 3> lo, hi;
  int longest() const {
    const float ex = hi[0] - lo[0], ey = hi[1] - lo[1], ez = hi[2] - lo[2];
    return ex >= ey && ex >= ez ? 0 : ey >= ez ? 1 : 2;
  }
};

Extent extent_of(std::span<const CutPoint> points) {
  Extent e{points[0].c, points[0].c};
  for (const CutPoint& point : points) {
    for (std::size_t a = 0; a < 3; ++a) {
      e.lo[a] = std::min(e.lo[a], point.c[a]);
      e.hi[a] = std::max(e.hi[a], point.c[a]);
    }
  }
  return e;
}

/// Moves the points for which goes_left() holds to the front, without a branch (Lomuto). Returns their number.
template <class Predicate>
std::size_t partition_branchless(CutPoint* points, std::size_t n, Predicate goes_left) {
  std::size_t left = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const CutPoint point = points[i];
    points[i] = points[left];
    points[left] = point;
    left += goes_left(point);
  }
  return left;
}

/// Returns a value near the `rank`-th smallest coordinate, from a strided sample.
float pivot_near(const CutPoint* points, std::size_t n, std::size_t rank, std::size_t axis) {
  constexpr std::size_t kMost = 31;
  const std::size_t m = n < 64 ? 5 : n < 512 ? 15 : kMost;
  std::array<float, kMost> sample{};
  for (std::size_t i = 0; i < m; ++i) sample[i] = points[i * n / m].c[axis];
  const std::size_t at = std::min(m - 1, rank * m / n);
  std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(at),
                   sample.begin() + static_cast<std::ptrdiff_t>(m));
  return sample[at];
}

/// Quickselect by the coordinate on `axis`: rearranges the points so that no point of the first `rank` exceeds a point
/// after them.
void select(CutPoint* points, std::size_t n, std::size_t rank, std::size_t axis) {
  while (rank > 0 && rank < n) {
    if (n <= 8) {
      std::sort(points, points + n, [axis](const CutPoint& a, const CutPoint& b) { return a.c[axis] < b.c[axis]; });
      return;
    }
    const float pivot = pivot_near(points, n, rank, axis);
    const std::size_t below = partition_branchless(points, n, [=](const CutPoint& i) { return i.c[axis] < pivot; });
    if (rank <= below && below < n) {
      n = below;
      continue;
    }
    const std::size_t equal =
        partition_branchless(points + below, n - below, [=](const CutPoint& i) { return !(pivot < i.c[axis]); });
    if (rank <= below + equal) return;
    points += below + equal, n -= below + equal, rank -= below + equal;
  }
}

using RowOf = std::function<std::uint64_t(std::uint32_t)>;

class Cutter {
 public:
  Cutter(const RowOf& row_of, std::uint32_t cell_points, std::vector<std::uint32_t>& begin)
      : row_of_(row_of), cell_points_(cell_points), begin_(begin) {}

  void into_cells(CutPoint* points, std::size_t n) {
    if (n <= cell_points_) {
      begin_.push_back(begin_.back() + static_cast<std::uint32_t>(n));
      return;
    }
    const Extent e = extent_of({points, n});
    const auto axis = static_cast<std::size_t>(e.longest());
    if (!(e.lo[axis] < e.hi[axis])) return same_place(points, n);
    // The split need not be exactly in the middle, since cells need not be full.
    const float pivot = pivot_near(points, n, n / 2, axis);
    std::size_t left = partition_branchless(points, n, [=](const CutPoint& i) { return i.c[axis] < pivot; });
    if (left < n / 4 || left > n - n / 4) {
      left = whole_leaves(n);
      select(points, n, left, axis);
    }
    into_cells(points, left);
    into_cells(points + left, n - left);
  }

 private:
  static std::size_t whole_leaves(std::size_t n) { return (n / kLeafCapacity + 1) / 2 * kLeafCapacity; }

  void same_place(CutPoint* points, std::size_t n) {
    by_row(points, n);
    for (std::size_t done = 0; done < n; done += cell_points_) {
      begin_.push_back(begin_.back() + static_cast<std::uint32_t>(std::min<std::size_t>(cell_points_, n - done)));
    }
  }

  void by_row(CutPoint* points, std::size_t n) const {
    std::sort(points, points + n,
              [this](const CutPoint& a, const CutPoint& b) { return row_of_(a.index) < row_of_(b.index); });
  }

  const RowOf& row_of_;
  std::uint32_t cell_points_;
  std::vector<std::uint32_t>& begin_;
};

}  // namespace

void cut_into_cells(std::span<CutPoint> points, std::uint32_t cell_points, const RowOf& row_of,
                    std::vector<std::uint32_t>& begin) {
  assert(cell_points % kLeafCapacity == 0 && cell_points <= kCellCapacity && cell_points > 0);
  begin.assign(1, 0);
  if (!points.empty()) Cutter(row_of, cell_points, begin).into_cells(points.data(), points.size());
}

void cut(std::span<CutPoint> points, std::uint32_t cell_points, const RowOf& row_of,
         std::vector<std::uint32_t>& begin) {
  cut_into_cells(points, cell_points, row_of, begin);
  for (std::size_t c = 0; c + 1 < begin.size(); ++c)
    cut_into_leaves(points.subspan(begin[c], begin[c + 1] - begin[c]), row_of);
}

}  // namespace pointsweep
