// SPDX-License-Identifier: MIT
/// Compares the normals of two PLY files row by row, up to sign. Prints one JSON object; fails if more than the given
/// share of rows is farther apart than 1e-4 rad (single-precision queries settle near-ties differently).
///   compare_normals A.ply B.ply [SHARE=0.001]
#include <algorithm>
#include <array>
#include <cmath>

#include "bench/normals/ply.h"

namespace {

double angle(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  const double ax = a[0], ay = a[1], az = a[2], bx = b[0], by = b[1], bz = b[2];
  return std::atan2(std::hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx),
                    std::abs(ax * bx + ay * by + az * bz));
}

std::size_t normal_offset(const bench::Ply& ply, const std::string& path) {
  const auto found = ply.triple("nx", "ny", "nz");
  if (!found || bench::Ply::bytes(found->second) != 4) bench::give_up(path + ": no nx, ny, nz of type float");
  return found->first;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) bench::give_up("usage: compare_normals A.ply B.ply [SHARE]");
  const double allowed = argc > 3 ? std::stod(argv[3]) : 0.001;
  const bench::Ply a(argv[1]), b(argv[2]);
  if (a.count != b.count) bench::give_up("different numbers of points");
  const std::size_t at_a = normal_offset(a, argv[1]), at_b = normal_offset(b, argv[2]);
  std::size_t differ = 0, zero_in_one = 0;
  for (std::size_t i = 0; i < a.count; ++i) {
    const auto n = a.get<std::array<float, 3>>(i, at_a), m = b.get<std::array<float, 3>>(i, at_b);
    const bool zero_a = n == std::array<float, 3>{}, zero_b = m == std::array<float, 3>{};
    zero_in_one += zero_a != zero_b;
    differ += zero_a != zero_b || (!zero_a && !(angle(n, m) <= 1e-4));
  }
  const double share = a.count == 0 ? 0 : double(differ) / double(a.count);
  std::printf("{\"points\": %zu, \"differ\": %zu, \"zero_in_one\": %zu, \"share\": %.3g}\n", a.count, differ,
              zero_in_one, share);
  return share > allowed ? 1 : 0;
}
