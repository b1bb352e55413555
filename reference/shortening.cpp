// SPDX-License-Identifier: MIT
#include "reference/shortening.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace pointsweep::reference {

std::vector<Rank> ranks_of(std::span<const Neighbor> neighbors) {
  std::vector<Rank> ranks;
  ranks.reserve(neighbors.size());
  for (const Neighbor& neighbor : neighbors) ranks.push_back(neighbor.rank());
  return ranks;
}

RuledPoint Shortening::ruled(StreamPoint& point) const {
  RuledPoint ruled{point.input, point.row, {}};
  for (const Field& field : reads_)
    ruled.attributes.insert(ruled.attributes.end(), field.in(point), field.in(point) + field.bytes);
  return ruled;
}

std::size_t Shortening::kept(const RuledPoint& point, std::span<const Rank> nearest_first) {
  if (!rule_) return nearest_first.size();
  x_.clear(), y_.clear(), z_.clear(), row_.clear(), slots_.clear();
  for (const Rank& rank : nearest_first) {
    x_.push_back(rank.position.x), y_.push_back(rank.position.y), z_.push_back(rank.position.z);
    row_.push_back(rank.row);
  }
  for (std::size_t i = 0; i < row_.size(); i += kCellCapacity)
    slots_.push_back({&x_[i], &y_[i], &z_[i], &row_[i], nullptr});
  while (refs_.size() < row_.size()) refs_.push_back(static_cast<NeighborRef>(refs_.size()));

  std::vector<const std::byte*> columns;
  std::vector<std::uint16_t> reads(reads_.size());
  std::iota(reads.begin(), reads.end(), std::uint16_t{0});
  const std::byte* value = point.attributes.data();
  for (const Field& field : reads_) columns.push_back(value), value += field.bytes;
  const PointColumns own{&point.position.x, &point.position.y, &point.position.z, &point.row, columns.data()};
  const std::array<std::uint32_t, 2> begin = {0, static_cast<std::uint32_t>(row_.size())};
  std::uint32_t count = 0;
  rule_->choose(Neighborhoods(own, 1, slots_.data(), begin.data(), refs_.data(), reads, {}), {&count, 1});
  return std::min<std::size_t>(count, row_.size());
}

void Shortening::shorten(StreamPoint& point) {
  if (rule_) point.neighbors.keep(kept(ruled(point), ranks_of(point.neighbors.found())));
}

}  // namespace pointsweep::reference
