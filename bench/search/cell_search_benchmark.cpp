// SPDX-License-Identifier: MIT
/// Times of cutting a cloud into cells and of searching neighbours, on one thread: points on a wavy closed surface, in
/// nanoseconds per point.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <random>

#include "pointsweep/search/cell_search.h"
#include "pointsweep/search/cut.h"

namespace pointsweep {
namespace {

struct Surface {
  std::vector<double> x, y, z;
  std::vector<std::uint64_t> row;
  explicit Surface(std::size_t n) {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> gauss;
    for (std::size_t i = 0; i < n; ++i) {
      Vec3 p{gauss(rng), gauss(rng), gauss(rng)};
      p = (1 / length(p)) * p;
      const double r = 1 + 0.1 * std::sin(9 * p.x) * std::sin(7 * p.y + 3 * p.z);
      x.push_back(static_cast<float>(r * p.x)), y.push_back(static_cast<float>(r * p.y));
      z.push_back(static_cast<float>(r * p.z)), row.push_back(i);
    }
  }
};

constexpr std::size_t kPoints = 200'000;

std::vector<CutPoint> cut_points(const Surface& s) {
  std::vector<CutPoint> points;
  for (std::uint32_t i = 0; i < s.x.size(); ++i) {
    points.push_back({{static_cast<float>(s.x[i]), static_cast<float>(s.y[i]), static_cast<float>(s.z[i])}, i});
  }
  return points;
}

std::uint64_t row_of(std::uint32_t index) { return index; }

void cut_surface(benchmark::State& state) {
  const std::vector<CutPoint> points = cut_points(Surface(kPoints));
  std::vector<std::uint32_t> begin;
  for (auto _ : state) {
    std::vector<CutPoint> moved = points;
    cut(moved, static_cast<std::uint32_t>(state.range(0)), row_of, begin);
  }
  state.counters["ns/point"] =
      benchmark::Counter(kPoints * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(cut_surface)->Arg(1024)->Unit(benchmark::kMillisecond);

void search_surface(benchmark::State& state) {
  const Surface s(kPoints);
  std::vector<CutPoint> moved = cut_points(s);
  std::vector<std::uint32_t> begin;
  cut(moved, static_cast<std::uint32_t>(state.range(1)), row_of, begin);
  CellDirectory directory;
  std::vector<std::unique_ptr<Cell>> cells;
  for (std::size_t i = 0; i + 1 < begin.size(); ++i) {
    cells.push_back(std::make_unique<Cell>(begin[i + 1] - begin[i]));
    for (std::uint32_t j = 0; j < cells[i]->size(); ++j) {
      const std::uint32_t from = moved[begin[i] + j].index;
      cells[i]->x[j] = s.x[from], cells[i]->y[j] = s.y[from], cells[i]->z[j] = s.z[from], cells[i]->row[j] = from;
    }
    cells[i]->seal();
    directory.add(static_cast<std::uint32_t>(i), cells[i].get());
  }
  const Neighborhood what{.k = static_cast<std::size_t>(state.range(0))};
  SearchScratch scratch;
  CellNeighbors found;
  for (auto _ : state) {
    for (std::uint32_t slot = 0; slot < cells.size(); ++slot) {
      search({directory, slot, what}, *cells[slot], kAllLists, scratch, found);
      benchmark::DoNotOptimize(found.refs.data());
    }
  }
  state.counters["ns/point"] =
      benchmark::Counter(kPoints * 1e-9, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["in double"] =
      static_cast<double>(scratch.settled_in_double) / static_cast<double>(kPoints * state.iterations());
}
BENCHMARK(search_surface)
    ->ArgsProduct({{8, 16, 32, 64, 65, 128, 384}, {1024}})
    ->ArgsProduct({{8}, {256, 512, 2048}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pointsweep
