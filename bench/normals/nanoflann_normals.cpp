// SPDX-License-Identifier: MIT
/// The contender of pointsweep's normals: equal files, equal formula (Equation 1), all threads, but nanoflann's kd-tree
/// and the whole cloud in memory.
///   nanoflann_normals IN OUT [-k 8 | --radius R] [--threads N] [--order file|permuted]
/// --radius: takes all points nearer than R, in the unsorted order of nanoflann's search.
/// --order permuted: the tree is built from points in Morton order and searched in Morton order, which avoids most
/// cache misses; results are written in the order of the file. The output has the format of the input, PLY or LAS.
/// Coordinates are float if those of the PLY file are, and if all integers of the LAS file lie within 2^24 steps of the
/// middle; else double. The contender does not write the LAS descriptors of the three appended floats, which saves it a
/// little time.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <nanoflann.hpp>
#include <numbers>
#include <numeric>
#include <thread>

#include "bench/normals/las.h"
#include "bench/normals/ply.h"

namespace bench {
namespace {

struct Options {
  std::string in, out;
  std::size_t k = 8;
  double radius = 0;  ///< positive: used instead of k
  std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
  bool permuted = false;
};

template <class T>
struct Cloud {
  std::vector<std::array<T, 3>> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  T kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

/// Calls work(begin, end) for pieces of [0, n) on `threads` threads.
void in_parallel(std::size_t n, std::size_t threads, const std::function<void(std::size_t, std::size_t)>& work) {
  constexpr std::size_t kPiece = 4096;
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> pool;
  for (std::size_t t = 0; t < threads; ++t)
    pool.emplace_back([&] {
      for (std::size_t begin; (begin = next.fetch_add(kPiece)) < n;) work(begin, std::min(n, begin + kPiece));
    });
}

std::uint64_t spread(std::uint64_t v) {  // puts two zeros between the 16 bits of v
  v = (v | v << 16) & 0x0000ff0000ff;
  v = (v | v << 8) & 0x00f00f00f00f;
  v = (v | v << 4) & 0x0c30c30c30c3;
  return (v | v << 2) & 0x249249249249;
}

/// Returns the rows in the order of a Morton curve with 2^16 cells per axis. Sorts in three passes of 16 bits.
template <class T>
std::vector<std::size_t> morton_order(const Cloud<T>& cloud, std::size_t threads) {
  struct Item {
    std::uint64_t code;
    std::size_t row;
  };
  const std::size_t n = cloud.points.size();
  std::array<T, 3> lo = cloud.points[0], hi = lo;
  for (const auto& p : cloud.points)
    for (std::size_t a = 0; a < 3; ++a) lo[a] = std::min(lo[a], p[a]), hi[a] = std::max(hi[a], p[a]);
  const double scale = 65535 / std::max({double(hi[0] - lo[0]), double(hi[1] - lo[1]), double(hi[2] - lo[2]), 1e-300});
  std::vector<Item> items(n), other(n);
  in_parallel(n, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::uint64_t code = 0;
      for (std::size_t a = 0; a < 3; ++a)
        code |= spread(std::uint64_t(double(cloud.points[i][a] - lo[a]) * scale)) << a;
      items[i] = {code, i};
    }
  });
  for (int shift = 0; shift < 48; shift += 16) {
    std::vector<std::size_t> first(65537);
    for (const Item& item : items) ++first[(item.code >> shift & 65535) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (const Item& item : items) other[first[item.code >> shift & 65535]++] = item;
    items.swap(other);
  }
  std::vector<std::size_t> rows(n);
  std::transform(items.begin(), items.end(), rows.begin(), [](const Item& item) { return item.row; });
  return rows;
}

/// Returns the normal of point i by Equation 1; (0, 0, 0) if the neighbours lie on a line. `farthest`: row of the
/// farthest neighbour.
template <class T>
std::array<float, 3> normal_of(const Cloud<T>& cloud, std::size_t i, const std::uint32_t* neighbors, std::size_t k,
                               std::uint32_t farthest) {
  using Vector = Eigen::Vector3d;
  const auto at = [&](std::size_t j) { return Vector(cloud.points[j][0], cloud.points[j][1], cloud.points[j][2]); };
  const Vector p = at(i);
  const double farthest2 = (at(farthest) - p).squaredNorm();
  const double falloff = double(k) / (2 * std::numbers::pi * farthest2);
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (std::size_t j = 0; j < k; ++j) {
    const Vector o = at(neighbors[j]) - p;
    const Vector w = std::exp(-o.squaredNorm() * falloff) * o;
    m(0, 0) += w.x() * o.x(), m(1, 0) += w.x() * o.y(), m(2, 0) += w.x() * o.z();
    m(1, 1) += w.y() * o.y(), m(2, 1) += w.y() * o.z(), m(2, 2) += w.z() * o.z();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(m);
  if (!(solver.eigenvalues()(1) > 1e-12 * solver.eigenvalues()(2))) return {};
  Vector n = solver.eigenvectors().col(0);
  Eigen::Index largest;
  n.cwiseAbs().maxCoeff(&largest);
  if (n[largest] < 0) n = -n;
  return {float(n.x()), float(n.y()), float(n.z())};
}

using Normals = std::vector<std::array<float, 3>>;

template <class T>
Normals normals_of(Cloud<T> cloud, const Options& options) {
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<T, Cloud<T>>, Cloud<T>, 3, std::uint32_t>;
  const std::size_t count = cloud.points.size();
  if (count == 0) return {};
  std::vector<std::size_t> rows;
  if (options.permuted) {
    rows = morton_order(cloud, options.threads);
    std::vector<std::array<T, 3>> ordered(count);
    for (std::size_t i = 0; i < count; ++i) ordered[i] = cloud.points[rows[i]];
    cloud.points.swap(ordered);
  }
  const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  Normals normals(count);
  if (options.radius > 0) {
    in_parallel(count, options.threads, [&](std::size_t begin, std::size_t end) {
      nanoflann::SearchParams parameters;
      parameters.sorted = false;
      std::vector<std::pair<std::uint32_t, T>> near;
      std::vector<std::uint32_t> found;
      for (std::size_t i = begin; i < end; ++i) {
        tree.radiusSearch(cloud.points[i].data(), T(options.radius * options.radius), near, parameters);
        found.clear();
        std::pair<std::uint32_t, T> farthest{0, T(-1)};
        for (const auto& one : near) {
          if (one.first == i) continue;
          found.push_back(one.first);
          if (one.second > farthest.second) farthest = one;
        }
        if (found.size() < 2) continue;
        normals[rows.empty() ? i : rows[i]] = normal_of(cloud, i, found.data(), found.size(), farthest.first);
      }
    });
    return normals;
  }
  in_parallel(count, options.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> found(options.k + 1);
    std::vector<T> distance2(options.k + 1);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t near = tree.knnSearch(cloud.points[i].data(), options.k + 1, found.data(), distance2.data());
      const auto self = std::find(found.begin(), found.begin() + std::ptrdiff_t(near), i);
      if (self != found.begin() + std::ptrdiff_t(near)) std::copy(self + 1, found.begin() + std::ptrdiff_t(near), self);
      if (near < 3) continue;
      normals[rows.empty() ? i : rows[i]] = normal_of(cloud, i, found.data(), near - 1, found[near - 2]);
    }
  });
  return normals;
}

template <class T>
Cloud<T> cloud_of(const Ply& ply, std::size_t offset) {
  Cloud<T> cloud;
  cloud.points.resize(ply.count);
  for (std::size_t i = 0; i < ply.count; ++i) cloud.points[i] = ply.get<std::array<T, 3>>(i, offset);
  return cloud;
}

/// Returns coordinates in steps of the scale of x, relative to the middle of the box. Normals depend neither on the
/// unit nor on the origin.
template <class T>
Cloud<T> cloud_of(const Las& las) {
  std::array<double, 3> middle, factor;
  for (std::size_t a = 0; a < 3; ++a) {
    middle[a] = std::floor((las.range(a)[0] + las.range(a)[1]) / 2);
    factor[a] = las.scale()[a] / las.scale()[0];
  }
  Cloud<T> cloud;
  cloud.points.resize(las.count);
  for (std::size_t i = 0; i < las.count; ++i)
    for (std::size_t a = 0; a < 3; ++a) cloud.points[i][a] = T((las.step(i, a) - middle[a]) * factor[a]);
  return cloud;
}

bool float_holds(const Las& las) {
  bool holds = true;
  for (std::size_t a = 0; a < 3; ++a) holds = holds && las.range(a)[1] - las.range(a)[0] < 0x1p25;
  return holds;
}

void write(const Ply& ply, const Normals& normals, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  for (const std::string& line : ply.header) out << line << '\n';
  const auto present = ply.triple("nx", "ny", "nz");
  const bool replace = present && Ply::bytes(present->second) == 4 && present->second.starts_with("float");
  if (!replace) out << "property float nx\nproperty float ny\nproperty float nz\n";
  out << "end_header\n";
  const std::size_t at = replace ? present->first : ply.stride;
  write_records(out, path, ply.count, replace ? ply.stride : ply.stride + kNormalBytes, [&](std::size_t i, char* to) {
    std::memcpy(to, ply.record(i), ply.stride);
    std::memcpy(to + at, &normals[i], kNormalBytes);
  });
}

void write(Las& las, const Normals& normals, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  las.set_entry(105, std::uint16_t(las.stride + kNormalBytes));
  out.write(las.head.data(), std::streamsize(las.head.size()));
  write_records(out, path, las.count, las.stride + kNormalBytes, [&](std::size_t i, char* to) {
    std::memcpy(to, las.record(i), las.stride);
    std::memcpy(to + las.stride, &normals[i], kNormalBytes);
  });
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] { return i + 1 < argc ? std::string(argv[++i]) : (give_up(word + " needs a value"), ""); };
    if (word == "-k")
      options.k = std::stoull(value());
    else if (word == "--radius")
      options.radius = std::stod(value());
    else if (word == "--threads")
      options.threads = std::stoull(value());
    else if (word == "--order")
      options.permuted = value() == "permuted";
    else if (options.in.empty())
      options.in = word;
    else
      options.out = word;
  }
  if (options.out.empty())
    give_up("usage: nanoflann_normals IN OUT [-k 8 | --radius R] [--threads N] [--order file|permuted]");
  return options;
}

void ply_normals(const Options& options) {
  const Ply ply(options.in);
  const auto position = ply.triple("x", "y", "z");
  if (!position) give_up(options.in + ": no x, y, z side by side");
  write(ply,
        Ply::bytes(position->second) == 4 ? normals_of(cloud_of<float>(ply, position->first), options)
                                          : normals_of(cloud_of<double>(ply, position->first), options),
        options.out);
}

void las_normals(const Options& options) {
  Las las(options.in);
  const Normals normals =
      float_holds(las) ? normals_of(cloud_of<float>(las), options) : normals_of(cloud_of<double>(las), options);
  write(las, normals, options.out);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  const Options options = parse(argc, argv);
  is_las(options.in) ? las_normals(options) : ply_normals(options);
}
