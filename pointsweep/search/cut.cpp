// SPDX-License-Identifier: MIT
#include "pointsweep/search/cut.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>

#include "pointsweep/points/neighborhoods.h"
#include "pointsweep/search/cell.h"

namespace pointsweep {

namespace {

/// A point on the move: coordinates in single precision are enough to choose sides, boxes are made from doubles later.
struct alignas(16) Item {
  std::array<float, 3> c;
  std::uint32_t index;
};

struct Extent {
  std::array<float, 3> lo, hi;
  int longest() const {
    const float ex = hi[0] - lo[0], ey = hi[1] - lo[1], ez = hi[2] - lo[2];
    return ex >= ey && ex >= ez ? 0 : ey >= ez ? 1 : 2;
  }
};

Extent extent_of(std::span<const Item> items) {
  Extent e{items[0].c, items[0].c};
  for (const Item& item : items) {
    for (std::size_t a = 0; a < 3; ++a) {
      e.lo[a] = std::min(e.lo[a], item.c[a]);
      e.hi[a] = std::max(e.hi[a], item.c[a]);
    }
  }
  return e;
}

/// Moves the items for which `goes_left` to the front without a branch (Lomuto) and returns how many there are.
template <class Predicate>
std::size_t partition_branchless(Item* items, std::size_t n, Predicate goes_left) {
  std::size_t left = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Item item = items[i];
    items[i] = items[left];
    items[left] = item;
    left += goes_left(item);
  }
  return left;
}

/// A value near the `rank`-th smallest coordinate, from a strided sample.
float pivot_near(const Item* items, std::size_t n, std::size_t rank, std::size_t axis) {
  constexpr std::size_t kMost = 31;
  const std::size_t m = n < 64 ? 5 : n < 512 ? 15 : kMost;
  std::array<float, kMost> sample{};
  for (std::size_t i = 0; i < m; ++i) sample[i] = items[i * n / m].c[axis];
  const std::size_t at = std::min(m - 1, rank * m / n);
  std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(at),
                   sample.begin() + static_cast<std::ptrdiff_t>(m));
  return sample[at];
}

/// Quickselect: afterwards the first `rank` items have no coordinate above those of the rest.
void select(Item* items, std::size_t n, std::size_t rank, std::size_t axis) {
  while (rank > 0 && rank < n) {
    if (n <= 8) {
      std::sort(items, items + n, [axis](const Item& a, const Item& b) { return a.c[axis] < b.c[axis]; });
      return;
    }
    const float pivot = pivot_near(items, n, rank, axis);
    const std::size_t below = partition_branchless(items, n, [=](const Item& i) { return i.c[axis] < pivot; });
    if (rank <= below && below < n) {
      n = below;
      continue;
    }
    const std::size_t equal =
        partition_branchless(items + below, n - below, [=](const Item& i) { return !(pivot < i.c[axis]); });
    if (rank <= below + equal) return;
    items += below + equal, n -= below + equal, rank -= below + equal;
  }
}

class Cutter {
 public:
  Cutter(std::span<const std::uint64_t> row, std::uint32_t cell_points, std::vector<std::uint32_t>& begin)
      : row_(row), cell_points_(cell_points), begin_(begin) {}

  void into_cells(Item* items, std::size_t n) {
    if (n <= cell_points_) {
      into_leaves(items, n);
      begin_.push_back(begin_.back() + static_cast<std::uint32_t>(n));
      return;
    }
    const Extent e = extent_of({items, n});
    const auto axis = static_cast<std::size_t>(e.longest());
    if (!(e.lo[axis] < e.hi[axis])) return same_place(items, n);
    // Any split near the middle will do: a cell need not be full.
    const float pivot = pivot_near(items, n, n / 2, axis);
    std::size_t left = partition_branchless(items, n, [=](const Item& i) { return i.c[axis] < pivot; });
    if (left < n / 4 || left > n - n / 4) {
      left = whole_leaves(n);
      select(items, n, left, axis);
    }
    into_cells(items, left);
    into_cells(items + left, n - left);
  }

 private:
  static std::size_t whole_leaves(std::size_t n) { return (n / kLeafCapacity + 1) / 2 * kLeafCapacity; }

  void into_leaves(Item* items, std::size_t n) {
    if (n <= kLeafCapacity) return;
    const Extent e = extent_of({items, n});
    const auto axis = static_cast<std::size_t>(e.longest());
    const std::size_t left = std::max<std::size_t>(whole_leaves(n), kLeafCapacity);
    if (!(e.lo[axis] < e.hi[axis])) return by_row(items, n);
    select(items, n, left, axis);
    into_leaves(items, left);
    into_leaves(items + left, n - left);
  }

  void same_place(Item* items, std::size_t n) {
    by_row(items, n);
    for (std::size_t done = 0; done < n; done += cell_points_) {
      begin_.push_back(begin_.back() + static_cast<std::uint32_t>(std::min<std::size_t>(cell_points_, n - done)));
    }
  }

  void by_row(Item* items, std::size_t n) const {
    std::sort(items, items + n, [this](const Item& a, const Item& b) { return row_[a.index] < row_[b.index]; });
  }

  std::span<const std::uint64_t> row_;
  std::uint32_t cell_points_;
  std::vector<std::uint32_t>& begin_;
};

}  // namespace

void cut(std::span<const double> x, std::span<const double> y, std::span<const double> z,
         std::span<const std::uint64_t> row, std::uint32_t cell_points, Cut& out) {
  assert(cell_points % kLeafCapacity == 0 && cell_points <= kCellCapacity && cell_points > 0);
  const std::size_t n = x.size();
  out.begin.assign(1, 0);
  out.order.resize(n);
  if (n == 0) return;
  const auto middle = [](double lo, double hi) { return 0.5 * lo + 0.5 * hi; };
  const auto [x_lo, x_hi] = std::minmax_element(x.begin(), x.end());
  const auto [y_lo, y_hi] = std::minmax_element(y.begin(), y.end());
  const auto [z_lo, z_hi] = std::minmax_element(z.begin(), z.end());
  const Vec3 o{middle(*x_lo, *x_hi), middle(*y_lo, *y_hi), middle(*z_lo, *z_hi)};
  std::vector<Item> items(n);
  for (std::size_t i = 0; i < n; ++i) {
    items[i] = {{static_cast<float>(x[i] - o.x), static_cast<float>(y[i] - o.y), static_cast<float>(z[i] - o.z)},
                static_cast<std::uint32_t>(i)};
  }
  Cutter(row, cell_points, out.begin).into_cells(items.data(), n);
  for (std::size_t i = 0; i < n; ++i) out.order[i] = items[i].index;
}

}  // namespace pointsweep
