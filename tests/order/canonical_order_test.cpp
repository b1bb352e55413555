// SPDX-License-Identifier: MIT
#include "pointsweep/order/canonical_order.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <tuple>

namespace pointsweep {
namespace {

struct Points {
  std::vector<double> x, y, z;
  std::vector<std::uint64_t> row;

  void add(double px, double py, double pz, std::uint64_t r) {
    x.push_back(px);
    y.push_back(py);
    z.push_back(pz);
    row.push_back(r);
  }
};

std::vector<std::uint32_t> by_comparing(int axis, const Points& p) {
  std::vector<std::uint32_t> order(p.row.size());
  std::iota(order.begin(), order.end(), 0u);
  const std::vector<double>& along = axis == 0 ? p.x : axis == 1 ? p.y : p.z;
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::tie(along[a], p.x[a], p.y[a], p.z[a], p.row[a]) < std::tie(along[b], p.x[b], p.y[b], p.z[b], p.row[b]);
  });
  return order;
}

void check(const Points& p) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::uint32_t> order = {99};
    canonical_order(axis, p.x, p.y, p.z, p.row, order);
    ASSERT_EQ(order, by_comparing(axis, p)) << "axis " << axis;
  }
}

Points made_by(std::size_t n, const std::function<double(int axis, std::size_t i)>& coordinate) {
  Points p;
  std::vector<std::uint64_t> rows(n);
  std::iota(rows.begin(), rows.end(), std::uint64_t{1} << 33);
  std::shuffle(rows.begin(), rows.end(), std::mt19937_64(3));
  for (std::size_t i = 0; i < n; ++i) p.add(coordinate(0, i), coordinate(1, i), coordinate(2, i), rows[i]);
  return p;
}

constexpr std::size_t kSizes[] = {0, 1, 2, 100, 128, 129, 5000};

TEST(CanonicalOrder, IsThatOfComparingForAnyNumbers) {
  rc::check([] {
    const auto number = rc::gen::weightedOneOf<double>(
        {{3, rc::gen::map(rc::gen::inRange(-2, 3), [](int i) { return 0.5 * i; })},
         {1, rc::gen::suchThat(rc::gen::arbitrary<double>(), [](double v) { return std::isfinite(v); })},
         {1, rc::gen::element(0.0, -0.0, 5e-324, -5e-324, 1.7e308, -1.7e308)}});
    Points p;
    const auto n = *rc::gen::inRange<std::size_t>(0, 400);
    const auto numbers = *rc::gen::container<std::vector<double>>(3 * n, number);
    for (std::size_t i = 0; i < n; ++i) p.add(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2], n - i);
    check(p);
    RC_ASSERT(!testing::Test::HasFailure());
  });
}

TEST(CanonicalOrder, SortsRandomFloatsAndDoubles) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1e3, 1e3);
  for (const std::size_t n : kSizes) {
    check(made_by(n, [&](int, std::size_t) { return uniform(random); }));
    check(made_by(n, [&](int, std::size_t) { return static_cast<double>(static_cast<float>(uniform(random))); }));
  }
}

TEST(CanonicalOrder, SortsByRowWhatIsIdentical) {
  for (const std::size_t n : kSizes)
    check(made_by(n, [](int axis, std::size_t i) { return axis == 1 && i % 2 ? -0.0 : 0.0; }));
}

TEST(CanonicalOrder, SortsGridsFullOfTies) {
  check(made_by(8000, [](int axis, std::size_t i) {
    return static_cast<double>(axis == 0 ? i % 20 : axis == 1 ? i / 20 % 20 : i / 400);
  }));
}

TEST(CanonicalOrder, TellsApartWhatDiffersInTheLastBitOnly) {
  // The first 32 significant bits of the keys have few values, so that later bits decide nearly all of the order.
  std::mt19937_64 random(12);
  check(made_by(4000, [&](int, std::size_t i) {
    if (i == 0) return -1e300;
    double v = 1000;
    for (std::uint64_t steps = random() % 40; steps > 0; --steps) v = std::nextafter(v, 2000.0);
    return v;
  }));
}

}  // namespace
}  // namespace pointsweep
