// SPDX-License-Identifier: MIT
/// Compares the normals of two PLY or two LAS files row by row, up to sign. Prints one JSON object; fails if more than
/// the given share of rows is farther apart than 1e-4 rad (single-precision queries settle near-ties differently).
///   compare_normals A B [SHARE=0.001]
/// In LAS the normals are the last twelve bytes of a record, because each program appends them to records without extra
/// bytes; all bytes before the normals must be equal. Rows whose kth and next neighbours are equally far may differ as
/// well, because only pointsweep has a rule for ties. Integer coordinates make ties in fewer than one row of 10,000 at
/// the scales of las_from_ply.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "bench/normals/las.h"
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

void require_same_points(const bench::Las& a, const bench::Las& b) {
  if (a.stride != b.stride || a.stride < 20 + bench::kNormalBytes) bench::give_up("records of different lengths");
  if (a.scale() != b.scale() || a.offset() != b.offset()) bench::give_up("different scales or offsets");
  for (std::size_t i = 0; i < std::min(a.count, b.count); ++i)
    if (std::memcmp(a.record(i), b.record(i), a.stride - bench::kNormalBytes) != 0)
      bench::give_up("record " + std::to_string(i) + " differs before its normal");
}

/// Prints the outcome, and returns the share of rows that differ.
double compare(const bench::Records& a, std::size_t at_a, const bench::Records& b, std::size_t at_b) {
  if (a.count != b.count) bench::give_up("different numbers of points");
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
  return share;
}

double compare_ply(const std::string& path_a, const std::string& path_b) {
  const bench::Ply a(path_a), b(path_b);
  return compare(a, normal_offset(a, path_a), b, normal_offset(b, path_b));
}

double compare_las(const std::string& path_a, const std::string& path_b) {
  const bench::Las a(path_a), b(path_b);
  require_same_points(a, b);
  return compare(a, a.stride - bench::kNormalBytes, b, b.stride - bench::kNormalBytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) bench::give_up("usage: compare_normals A B [SHARE]");
  const double allowed = argc > 3 ? std::stod(argv[3]) : 0.001;
  const double share = bench::is_las(argv[1]) ? compare_las(argv[1], argv[2]) : compare_ply(argv[1], argv[2]);
  return share > allowed ? 1 : 0;
}
