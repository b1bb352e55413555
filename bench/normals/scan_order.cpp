// SPDX-License-Identifier: MIT
/// Writes the points of a file in the order of a scanner: line after line across the cloud, forth and back. Programs
/// that search in file order run faster on such files.
///   scan_order IN OUT
/// The output has the format of the input, PLY or LAS.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "bench/normals/las.h"
#include "bench/normals/ply.h"

namespace bench {
namespace {

/// The place of a point in scan order: its line, then its place along the line, backwards in every other line.
struct Place {
  std::int64_t line;
  double along;
  bool operator<(const Place& other) const { return line != other.line ? line < other.line : along < other.along; }
};

/// Returns the rows in scan order. at(i, axis) returns a coordinate of point i, in any unit.
template <class At>
std::vector<std::size_t> scan_order(std::size_t count, At at) {
  if (count == 0) return {};
  double lo = at(0, 0), hi = lo;
  for (std::size_t i = 0; i < count; ++i) lo = std::min(lo, at(i, 0)), hi = std::max(hi, at(i, 0));
  const double lines = std::max(1.0, std::sqrt(double(count)) / 2);
  std::vector<Place> places(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto line = std::int64_t((at(i, 0) - lo) / std::max(hi - lo, 1e-300) * lines);
    places[i] = {line, line % 2 == 0 ? at(i, 1) : -at(i, 1)};
  }
  std::vector<std::size_t> rows(count);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return places[a] < places[b]; });
  return rows;
}

void write(std::ofstream& out, const Records& records, const std::vector<std::size_t>& rows, const std::string& path) {
  write_records(out, path, records.count, records.stride,
                [&](std::size_t i, char* to) { std::memcpy(to, records.record(rows[i]), records.stride); });
}

template <class T>
std::vector<std::size_t> scan_order_of(const Ply& ply, std::size_t offset) {
  return scan_order(ply.count,
                    [&](std::size_t i, std::size_t axis) { return double(ply.get<T>(i, offset + axis * sizeof(T))); });
}

void order_ply(const std::string& from, const std::string& to) {
  const Ply ply(from);
  const auto position = ply.triple("x", "y", "z");
  if (!position) give_up(from + ": no x, y, z side by side");
  const bool single = Ply::bytes(position->second) == 4;
  std::ofstream out(to, std::ios::binary);
  for (const std::string& line : ply.header) out << line << '\n';
  out << "end_header\n";
  write(out, ply, single ? scan_order_of<float>(ply, position->first) : scan_order_of<double>(ply, position->first),
        to);
}

void order_las(const std::string& from, const std::string& to) {
  const Las las(from);
  std::ofstream out(to, std::ios::binary);
  out.write(las.head.data(), std::streamsize(las.head.size()));
  write(out, las, scan_order(las.count, [&](std::size_t i, std::size_t axis) { return double(las.step(i, axis)); }),
        to);
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  if (argc != 3) give_up("usage: scan_order IN OUT");
  is_las(argv[1]) ? order_las(argv[1], argv[2]) : order_ply(argv[1], argv[2]);
}
