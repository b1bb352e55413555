// SPDX-License-Identifier: MIT
/// Writes PLY files of clouds that are hard for an engine, for script/hostile. Point i is a function of i, the number
/// of points and the name; the first rows of a cloud already hold the points that make it hard.
///   hostile_cloud NAME POINTS OUT.ply
///   hostile_cloud --list
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace {

using Point = std::array<double, 3>;
using Index = std::uint64_t;

/// Returns random number `stream` of row `i`, uniform in [0, 1) (SplitMix64).
double random(Index i, Index stream) {
  std::uint64_t z = (i * 16 + stream + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/// Returns a point on an ellipsoid 4 high and 2 wide; u in [0, 1) ascends along z.
Point on_surface(double u, double turn) {
  const double z = 2 * u - 1, radius = std::sqrt(1 - z * z), angle = 2 * std::numbers::pi * turn;
  return {radius * std::cos(angle), radius * std::sin(angle), 2 * z};
}
Point surface(Index i, Index) { return on_surface(random(i, 0), random(i, 1)); }

/// Returns a point on the ellipsoid of on_surface(). Points with p = 0 .. n - 1 ascend along z.
Point in_place(Index p, Index n) {
  return on_surface((static_cast<double>(p) + random(p, 0)) / static_cast<double>(n), random(p, 1));
}

/// Returns a point of a terrestrial scan from a station at (x, y) on a floor. The density falls as 1/r^2 between r =
/// 0.1 and r = 100.
Point station(Index i, double x, double y) {
  const double r = 0.1 * std::pow(1e3, random(i, 0)), angle = 2 * std::numbers::pi * random(i, 1);
  return {x + r * std::cos(angle), y + r * std::sin(angle), 0.02 * std::sin(r) + 0.001 * random(i, 2)};
}

Point shifted(Point p, double by) { return {p[0] + by, p[1] + by, p[2] + by}; }
Point scaled(Point p, double by) { return {p[0] * by, p[1] * by, p[2] * by}; }
/// Multiplies by 100 and rounds to whole 1024ths, about millimetres, which float64 holds exactly near 5e6 as well.
Point in_millimetres(Point p) {
  return {std::round(p[0] * 102400) / 1024, std::round(p[1] * 102400) / 1024, std::round(p[2] * 102400) / 1024};
}

struct Kind {
  const char* name;
  bool wide;  ///< coordinates as float64
  std::function<Point(Index i, Index n)> point;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = {
      {"surface", false, surface},
      {"two-far-clusters", false,
       [](Index i, Index n) {
         return i < 9 ? shifted(scaled(surface(i, n), 0.01), i < 4 ? 500 : -300) : surface(i, n);
       }},
      {"one-point-far-away", false,
       [](Index i, Index n) {
         return i == 0 ? Point{4e6, 1e6, -3e6} : surface(i, n);
       }},
      {"three-stations", false, [](Index i, Index) { return station(i, i % 3 == 0 ? 0 : 40, i % 3 == 2 ? 30.0 : 0); }},
      {"wall-across", false,
       [](Index i, Index) -> Point {
         if (random(i, 3) < 0.3) return {5 + 0.005 * (random(i, 2) - 0.5), random(i, 0), random(i, 1)};
         return {100 * random(i, 0), random(i, 1), 0.001 * random(i, 2)};
       }},
      {"walls", false,
       [](Index i, Index) -> Point {
         const double across = 4 * static_cast<double>(i % 5) + 0.004 * random(i, 2), u = 20 * random(i, 0);
         return i % 2 == 0 ? Point{across, u, 3 * random(i, 1)} : Point{u, across, 3 * random(i, 1)};
       }},
      {"dense-ball", false,
       [](Index i, Index) {
         const Point p = on_surface(random(i, 0), random(i, 1));
         const double radius = (i % 4 == 0 ? 10 : 1) * std::cbrt(random(i, 2));
         return Point{radius * p[0], radius * p[1], radius * p[2] / 2};
       }},
      {"twice", false, [](Index i, Index) { return surface(i / 2, 0); }},
      {"ten-times", false, [](Index i, Index) { return surface(i / 10, 0); }},
      {"thousand-times", false, [](Index i, Index) { return surface(i / 1000, 0); }},
      {"most-at-one-place", false,
       [](Index i, Index n) {
         return i % 16 != 0 ? Point{0.6, 0, 1.6} : surface(i, n);
       }},
      {"all-identical", false,
       [](Index, Index) {
         return Point{1, 2, 3};
       }},
      {"plane-across", false,
       [](Index i, Index) {
         return Point{random(i, 0), random(i, 1), i == 0 ? 1e3 : 0};
       }},
      {"plane-along", false,
       [](Index i, Index) {
         return Point{2 * random(i, 0), random(i, 1), 0};
       }},
      {"line", false,
       [](Index i, Index) {
         return Point{random(i, 0), 0, 0};
       }},
      {"skew-line", true,
       [](Index i, Index) {
         return scaled({1, 2, 3}, random(i, 0));
       }},
      {"grid", false,
       [](Index i, Index n) {
         const auto side = static_cast<Index>(std::ceil(std::cbrt(static_cast<double>(n)) - 1e-9));
         return Point{double(i % side), double(i / side % side), double(i / side / side)};
       }},
      {"millimetres", true, [](Index i, Index n) { return in_millimetres(surface(i, n)); }},
      {"millimetres-at-5e6", true, [](Index i, Index n) { return shifted(in_millimetres(surface(i, n)), 5e6); }},
      {"near-1e12", true, [](Index i, Index n) { return shifted(scaled(surface(i, n), 100), 1e12); }},
      {"extent-1e-12", true, [](Index i, Index n) { return scaled(surface(i, n), 1e-12); }},
      {"denormals", true, [](Index i, Index n) { return scaled(surface(i, n), 1e-310); }},
      {"not-finite", false,
       [](Index i, Index n) {
         Point p = surface(i, n);
         if (i % 100 == 0) p[i / 100 % 3] = i % 200 == 0 ? NAN : std::numeric_limits<double>::infinity();
         return p;
       }},
      {"backwards", false, [](Index i, Index n) { return in_place(n - 1 - i, n); }},
      {"organ-pipe", false,
       [](Index i, Index n) { return in_place(i < (n + 1) / 2 ? 2 * i : 2 * (n - 1 - i) + 1, n); }},
      {"one-slab", false,
       [](Index i, Index) {
         return Point{random(i, 0), random(i, 1), i % 100 == 0 ? 50 * random(i, 2) : 1e-4 * random(i, 2)};
       }},
  };
  return all;
}

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "hostile_cloud: %s\n", why.c_str());
  std::exit(1);
}

template <class Number>
void write_points(const Kind& kind, Index n, std::FILE* file) {
  constexpr Index kChunk = 1 << 16;
  std::vector<Number> numbers;
  for (Index first = 0; first < n; first += kChunk) {
    numbers.clear();
    for (Index i = first; i < std::min(n, first + kChunk); ++i)
      for (const double v : kind.point(i, n)) numbers.push_back(static_cast<Number>(v));
    if (std::fwrite(numbers.data(), sizeof(Number), numbers.size(), file) != numbers.size()) give_up("cannot write");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Kind>& all = kinds();
  if (argc == 2 && std::string(argv[1]) == "--list") {
    for (const Kind& kind : all) std::puts(kind.name);
    return 0;
  }
  if (argc != 4) give_up("usage: hostile_cloud NAME POINTS OUT.ply, or --list");
  const auto kind = std::find_if(all.begin(), all.end(), [&](const Kind& k) { return k.name == std::string(argv[1]); });
  if (kind == all.end()) give_up(std::string("no cloud is called ") + argv[1]);
  const Index n = std::stoull(argv[2]);
  std::FILE* file = std::fopen(argv[3], "wb");
  if (file == nullptr) give_up(std::string("cannot create ") + argv[3]);
  const char* type = kind->wide ? "double" : "float";
  std::fprintf(file,
               "ply\nformat binary_little_endian 1.0\nelement vertex %llu\nproperty %s x\nproperty %s y\nproperty %s "
               "z\nend_header\n",
               static_cast<unsigned long long>(n), type, type, type);
  kind->wide ? write_points<double>(*kind, n, file) : write_points<float>(*kind, n, file);
  if (std::fclose(file) != 0) give_up(std::string("cannot write ") + argv[3]);
}
