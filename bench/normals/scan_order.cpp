// SPDX-License-Identifier: MIT
/// The same points in the order of a scanner: line after line across the cloud, forth and back, which is kinder to
/// programs that search in file order.
///   scan_order IN.ply OUT.ply
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "bench/normals/ply.h"

namespace bench {
namespace {

/// By line, then along it, every other line backwards.
struct Place {
  std::int64_t line;
  double along;
  bool operator<(const Place& other) const { return line != other.line ? line < other.line : along < other.along; }
};

template <class T>
std::vector<std::size_t> scan_order(const Ply& ply, std::size_t offset) {
  const auto at = [&](std::size_t i, std::size_t axis) { return double(ply.get<T>(i, offset + axis * sizeof(T))); };
  double lo = at(0, 0), hi = lo;
  for (std::size_t i = 0; i < ply.count; ++i) lo = std::min(lo, at(i, 0)), hi = std::max(hi, at(i, 0));
  const double lines = std::max(1.0, std::sqrt(double(ply.count)) / 2);
  std::vector<Place> places(ply.count);
  for (std::size_t i = 0; i < ply.count; ++i) {
    const auto line = std::int64_t((at(i, 0) - lo) / std::max(hi - lo, 1e-300) * lines);
    places[i] = {line, line % 2 == 0 ? at(i, 1) : -at(i, 1)};
  }
  std::vector<std::size_t> rows(ply.count);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::sort(rows.begin(), rows.end(), [&](std::size_t a, std::size_t b) { return places[a] < places[b]; });
  return rows;
}

void write(const Ply& ply, const std::vector<std::size_t>& rows, const std::string& path) {
  std::ofstream out(path, std::ios::binary);
  for (const std::string& line : ply.header) out << line << '\n';
  out << "end_header\n";
  std::vector<char> block;
  for (std::size_t i = 0; i < rows.size();) {
    block.clear();
    for (; i < rows.size() && block.size() < (std::size_t{4} << 20); ++i)
      block.insert(block.end(), ply.record(rows[i]), ply.record(rows[i]) + ply.stride);
    out.write(block.data(), std::streamsize(block.size()));
  }
  if (!out.flush()) give_up(path + ": cannot write");
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
  using namespace bench;
  if (argc != 3) give_up("usage: scan_order IN.ply OUT.ply");
  const Ply ply(argv[1]);
  const auto position = ply.triple("x", "y", "z");
  if (!position) give_up(std::string(argv[1]) + ": no x, y, z side by side");
  const bool single = Ply::bytes(position->second) == 4;
  write(ply, single ? scan_order<float>(ply, position->first) : scan_order<double>(ply, position->first), argv[2]);
}
