// SPDX-License-Identifier: MIT
/// The bare cost of the parts that no run can avoid, each alone on one thread: copying the bytes of input and output, a
/// radix sort of the points' keys, the search kernel on candidates that are in cache, and the kernel of Equation 1 on
/// neighbourhoods that are in cache. Prints CPU seconds as JSON.
///   bare_parts IN.ply OUTPUT_BYTES SCRATCH_FILE
#include <cstdio>
#include <ctime>

#include "bench/normals/ply.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/limits/bare_parts.cpp"
#include "pointsweep/math/instruction_sets.h"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <random>

#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/search/leaf_query-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {

/// Searches k = 8 neighbours in `leaves` leaves for `points` points. Returns a sum of the last results, so that the
/// compiler removes nothing.
float search_in_cache(std::size_t points, std::uint32_t leaves) {
  const Lanes d;
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  static Packed packed;
  for (std::uint32_t i = 0; i < leaves * kLeafCapacity; ++i)
    packed.x[i] = 2 * uniform(rng), packed.y[i] = 2 * uniform(rng), packed.z[i] = 0.1f * uniform(rng);
  float sum = 0;
  Group<8> group;
  group.radius_key = hn::Set(d, kEmptyKey);
  for (std::size_t i = 0; i < points; i += hn::Lanes(d)) {
    const Vec shift = hn::Set(d, static_cast<float>(i % 64) * 0x1p-10f);
    group.x = hn::Add(hn::Load(d, packed.x), shift), group.y = hn::Load(d, packed.y), group.z = hn::Load(d, packed.z);
    group.selection.start(d, 8);
    packed.leaves = 1;
    group.try_own_leaf(d, packed, 0);
    while (packed.leaves++ < leaves) group.try_last_leaf(d, packed);
    sum += hn::GetLane(group.selection.list[7]);
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();
#else
namespace pointsweep::HWY_NAMESPACE {
float search_in_cache(std::size_t, std::uint32_t) { return 0; }
}  // namespace pointsweep::HWY_NAMESPACE
#endif

#if HWY_ONCE
namespace pointsweep {
HWY_EXPORT(search_in_cache);
}

namespace bench {
namespace {

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

template <class Work>
double cost(Work work) {
  const double begin = cpu_seconds();
  work();
  return cpu_seconds() - begin;
}

/// Reads the whole input and writes as many bytes as the output has, a few megabytes at a time.
void copy(const std::string& in, std::size_t output_bytes, const std::string& out) {
  std::vector<char> block(std::size_t{4} << 20);
  std::FILE* from = std::fopen(in.c_str(), "rb");
  std::FILE* to = std::fopen(out.c_str(), "wb");
  if (!from || !to) give_up(in + " or " + out + ": cannot open");
  std::setvbuf(from, nullptr, _IONBF, 0), std::setvbuf(to, nullptr, _IONBF, 0);
  while (std::fread(block.data(), 1, block.size(), from) == block.size()) {
  }
  for (std::size_t left = output_bytes; left > 0;) {
    const std::size_t n = std::min(left, block.size());
    if (std::fwrite(block.data(), 1, n, to) != n) give_up(out + ": cannot write");
    left -= n;
  }
  std::fclose(from), std::fclose(to);
  std::remove(out.c_str());
}

struct Item {
  std::uint32_t key, row;
};

/// Sorts by key, in three passes of eleven bits.
void radix_sort(std::vector<Item>& items) {
  std::vector<Item> other(items.size());
  for (int shift = 0; shift < 33; shift += 11) {
    std::vector<std::size_t> first(2049);
    for (const Item& item : items) ++first[(item.key >> shift & 2047) + 1];
    for (std::size_t b = 0; b < 2048; ++b) first[b + 1] += first[b];
    for (const Item& item : items) other[first[item.key >> shift & 2047]++] = item;
    items.swap(other);
  }
}

/// Returns the x coordinates as integer keys whose order is that of the coordinates.
std::vector<Item> keys_of(const Ply& ply) {
  const auto position = ply.triple("x", "y", "z");
  if (!position || Ply::bytes(position->second) != 4) give_up("no single precision x, y, z side by side");
  std::vector<Item> items(ply.count);
  for (std::size_t i = 0; i < ply.count; ++i) {
    const auto bits = ply.get<std::uint32_t>(i, position->first);
    items[i] = {bits >> 31 ? ~bits : bits | 0x80000000u, std::uint32_t(i)};
  }
  return items;
}

/// Computes Equation 1 for `points` points, one cell at a time, always the same cell.
void normals_in_cache(std::size_t points) {
  constexpr std::size_t kCell = 1024, kNeighbors = 8;
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> x(kCell), y(kCell), z(kCell);
  for (std::size_t i = 0; i < kCell; ++i) x[i] = uniform(rng), y[i] = uniform(rng), z[i] = 0.1 * uniform(rng);
  std::vector<std::uint32_t> begin{0};
  std::vector<pointsweep::NeighborRef> refs;
  for (std::size_t i = 0; i < kCell; ++i) {
    for (std::size_t j = 1; j <= kNeighbors; ++j) refs.push_back(std::uint32_t((i + 7 * j) % kCell));
    begin.push_back(std::uint32_t(refs.size()));
  }
  const pointsweep::PointColumns own{x.data(), y.data(), z.data(), nullptr, nullptr};
  const pointsweep::Neighborhoods in(own, kCell, &own, begin.data(), refs.data(), {}, {});
  std::vector<std::array<float, 3>> normals(kCell);
  pointsweep::DegeneratePoints none;
  for (std::size_t done = 0; done < points; done += kCell) pointsweep::unoriented_normals(in, normals, none);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  if (argc != 4) give_up("usage: bare_parts IN.ply OUTPUT_BYTES SCRATCH_FILE");
  // Leaves searched per point: 6.8 to 7.3, counted on statue, terrain and tls with k = 8 and groups of eight queries.
  constexpr std::uint32_t kLeaves = 7;
  const double copying = cost([&] { copy(argv[1], std::stoull(argv[2]), argv[3]); });
  const Ply ply(argv[1]);
  std::vector<Item> items = keys_of(ply);
  const double sorting = cost([&] { radix_sort(items); });
  float sum = 0;
  const double searching = cost([&] { sum = HWY_DYNAMIC_DISPATCH(pointsweep::search_in_cache)(ply.count, kLeaves); });
  const double fitting = cost([&] { normals_in_cache(ply.count); });
  std::printf(
      "{\"copy\": %.4f, \"sort\": %.4f, \"search\": %.4f, \"normals\": %.4f, \"candidates\": %u, \"check\": %g}\n",
      copying, sorting, searching, fitting, kLeaves * pointsweep::kLeafCapacity, double(sum));
}
#endif
