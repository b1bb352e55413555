// SPDX-License-Identifier: MIT
#include "pointsweep/operators/neighbor_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointsweep {

namespace {
std::vector<std::string> numbered(const std::string& name, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(name + "_" + std::to_string(i));
  return names;
}
}  // namespace

NeighborRows::NeighborRows(std::size_t k, std::uint64_t rows, bool distances)
    : k_(k), wide_(rows >= std::numeric_limits<std::uint32_t>::max()), distances_(distances) {}

Contract NeighborRows::contract() const {
  Contract c;
  c.makes.push_back({"neighbors", wide_ ? Type::u64 : Type::u32, Kind::index, numbered("neighbor", k_), "",
                     "input rows of the k nearest neighbours, nearest first", std::byte{0xFF}});
  if (distances_) {
    c.makes.push_back({"distances", Type::f64, Kind::scalar, numbered("distance", k_), "length",
                       "distances to the k nearest neighbours", std::byte{0xFF}});
  }
  return c;
}

template <class Row>
void NeighborRows::write_rows(const Neighborhoods& in, Row* out) const {
  for (std::size_t i = 0; i < in.size(); ++i, out += k_) {
    const std::size_t found = std::min(in.count(i), k_);
    for (std::size_t j = 0; j < found; ++j) out[j] = static_cast<Row>(in.neighbor_row(i, j));
    std::fill(out + found, out + k_, std::numeric_limits<Row>::max());
  }
}

void NeighborRows::apply(const Neighborhoods& in, Columns& out) const {
  // A column's values are k wide, so only its first byte is taken from the span.
  if (wide_) {
    write_rows(in, out.column<std::uint64_t>(0).data());
  } else {
    write_rows(in, out.column<std::uint32_t>(0).data());
  }
  if (!distances_) return;
  double* distance = out.column<double>(1).data();
  for (std::size_t i = 0; i < in.size(); ++i, distance += k_) {
    const std::size_t found = std::min(in.count(i), k_);
    for (std::size_t j = 0; j < found; ++j) distance[j] = std::sqrt(in.distance2(i, j));
    std::fill(distance + found, distance + k_, std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace pointsweep
