// SPDX-License-Identifier: MIT
/// Times of the kernel of normals on one thread with given neighbours: a wavy sheet cut into cells of 1024 points, in
/// nanoseconds per point.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {
namespace {

constexpr std::size_t kTile = 32, kTiles = 12, kSide = kTile * kTiles, kCell = kTile * kTile;

/// Points of a jittered grid, tile by tile; the neighbours of a point are the k nearest within a few steps of it.
struct Sheet {
  std::vector<double> x, y, z;
  std::vector<PointColumns> cells;
  std::vector<std::vector<std::uint32_t>> begins;
  std::vector<std::vector<NeighborRef>> refs;

  static std::size_t index(std::size_t r, std::size_t c) {
    return (r / kTile * kTiles + c / kTile) * kCell + r % kTile * kTile + c % kTile;
  }

  explicit Sheet(std::size_t k) : x(kSide * kSide), y(x), z(x) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> jitter(-0.4, 0.4);
    for (std::size_t r = 0; r < kSide; ++r)
      for (std::size_t c = 0; c < kSide; ++c) {
        const std::size_t i = index(r, c);
        x[i] = double(c) + jitter(random), y[i] = double(r) + jitter(random);
        z[i] = 5 * std::sin(0.05 * x[i]) * std::cos(0.07 * y[i]);
      }
    for (std::size_t cell = 0; cell < kTiles * kTiles; ++cell) {
      cells.push_back({&x[cell * kCell], &y[cell * kCell], &z[cell * kCell], nullptr, nullptr});
      begins.push_back({0}), refs.emplace_back();
      for (std::size_t i = 0; i < kCell; ++i) {
        add_neighbors(cell / kTiles * kTile + i / kTile, cell % kTiles * kTile + i % kTile, k, refs.back());
        begins.back().push_back(std::uint32_t(refs.back().size()));
      }
    }
  }

  void add_neighbors(std::size_t r, std::size_t c, std::size_t k, std::vector<NeighborRef>& out) const {
    const std::size_t reach = std::size_t(std::sqrt(double(k))) / 2 + 2, self = index(r, c);
    std::vector<std::pair<double, std::size_t>> near;
    for (std::size_t row = r - std::min(r, reach); row < std::min(kSide, r + reach + 1); ++row)
      for (std::size_t col = c - std::min(c, reach); col < std::min(kSide, c + reach + 1); ++col)
        if (const std::size_t j = index(row, col); j != self)
          near.emplace_back(distance2({x[j], y[j], z[j]}, {x[self], y[self], z[self]}), j);
    std::sort(near.begin(), near.end());
    for (std::size_t n = 0; n < std::min(k, near.size()); ++n)
      out.push_back(make_ref(std::uint32_t(near[n].second / kCell), std::uint32_t(near[n].second % kCell)));
  }
};

void normals_of_a_sheet(benchmark::State& state) {
  const Sheet sheet(std::size_t(state.range(0)));
  const Normals normals;
  std::vector<std::array<float, 3>> column(kCell);
  std::byte* made[] = {reinterpret_cast<std::byte*>(column.data())};
  for (auto _ : state)
    for (std::size_t cell = 0; cell < sheet.cells.size(); ++cell) {
      DegeneratePoints degenerate;
      Columns out(made, kCell, degenerate);
      normals.apply(
          {sheet.cells[cell], kCell, sheet.cells.data(), sheet.begins[cell].data(), sheet.refs[cell].data(), {}, {}},
          out);
      benchmark::DoNotOptimize(column.data());
    }
  state.counters["ns/point"] = benchmark::Counter(
      double(kSide * kSide) * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(normals_of_a_sheet)->Arg(8)->Arg(16)->Arg(64);

}  // namespace
}  // namespace pointsweep
