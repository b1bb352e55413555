// SPDX-License-Identifier: MIT
/// Writes the points of a PLY file as plain LAS, like a scanner: version 1.4, point format 6, no extra bytes, one scale
/// for all axes.
///   las_from_ply IN.ply OUT.las
/// The scale is the largest power of ten that is at most a 300th of the spacing. The spacing is that of as many points
/// spread over a square whose side is the longest side of the bounding box: a millimetre for an airborne scan, a
/// micrometre for a statue.
#include <algorithm>
#include <cmath>

#include "bench/normals/las.h"
#include "bench/normals/ply.h"

namespace bench {
namespace {

using Point = std::array<double, 3>;

struct Box {
  Point lo, hi;
  double longest() const { return std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]}); }
};

template <class T>
std::vector<Point> points_of(const Ply& ply, std::size_t offset) {
  std::vector<Point> points(ply.count);
  for (std::size_t i = 0; i < ply.count; ++i) {
    const auto p = ply.get<std::array<T, 3>>(i, offset);
    points[i] = {p[0], p[1], p[2]};
  }
  return points;
}

Box box_of(const std::vector<Point>& points) {
  Box box{points[0], points[0]};
  for (const Point& p : points)
    for (std::size_t a = 0; a < 3; ++a) box.lo[a] = std::min(box.lo[a], p[a]), box.hi[a] = std::max(box.hi[a], p[a]);
  return box;
}

double scale_of(const Box& box, std::size_t count) {
  const double spacing = box.longest() / std::sqrt(double(count));
  const double scale = std::stod("1e" + std::to_string(int(std::floor(std::log10(std::max(spacing, 1e-9) / 300)))));
  if (box.longest() / scale > 0x1p31) give_up("the box is too long for 32 bits a coordinate");
  return scale;
}

/// Returns the header of a LAS 1.4 file without VLRs. steps(value, axis) returns the integer of a coordinate; the box
/// in the header is that of the rounded coordinates.
template <class Steps>
Las head_of(const Box& box, std::size_t count, double scale, const Point& offset, Steps steps) {
  Las las;
  las.head.assign(375, 0);
  std::memcpy(las.head.data(), "LASF", 4);
  las.set_entry(6, std::uint16_t{16});  // WKT bit, which point format 6 requires even without a system
  las.set_entry(24, std::uint16_t{0x0401});
  las.set_entry(94, std::uint16_t{375});
  las.set_entry(96, std::uint32_t{375});
  las.set_entry(104, std::uint8_t{6});
  las.set_entry(105, std::uint16_t{30});
  las.set_entry(131, Point{scale, scale, scale});
  las.set_entry(155, offset);
  for (std::size_t a = 0; a < 3; ++a) {
    las.set_entry(179 + 16 * a, offset[a] + scale * steps(box.hi[a], a));
    las.set_entry(187 + 16 * a, offset[a] + scale * steps(box.lo[a], a));
  }
  las.set_entry(247, std::uint64_t(count));
  las.set_entry(255, std::uint64_t(count));  // all points are first returns
  return las;
}

void convert(const std::vector<Point>& points, const std::string& path) {
  const Box box = box_of(points);
  const double scale = scale_of(box, points.size());
  const Point offset{std::round(box.lo[0]), std::round(box.lo[1]), std::round(box.lo[2])};
  const auto steps = [&](double value, std::size_t a) {
    return std::int32_t(std::lround((value - offset[a]) / scale));
  };
  const Las las = head_of(box, points.size(), scale, offset, steps);
  std::ofstream out(path, std::ios::binary);
  out.write(las.head.data(), std::streamsize(las.head.size()));
  write_records(out, path, points.size(), 30, [&](std::size_t i, char* to) {
    std::array<char, 30> record{};
    const std::array<std::int32_t, 3> xyz{steps(points[i][0], 0), steps(points[i][1], 1), steps(points[i][2], 2)};
    std::memcpy(record.data(), xyz.data(), sizeof xyz);
    record[14] = 0x11;  // return 1 of 1
    std::copy(record.begin(), record.end(), to);
  });
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  if (argc != 3) give_up("usage: las_from_ply IN.ply OUT.las");
  const Ply ply(argv[1]);
  const auto position = ply.triple("x", "y", "z");
  if (!position || ply.count == 0) give_up(std::string(argv[1]) + ": no x, y, z side by side, or no points");
  convert(Ply::bytes(position->second) == 4 ? points_of<float>(ply, position->first)
                                            : points_of<double>(ply, position->first),
          argv[2]);
}
