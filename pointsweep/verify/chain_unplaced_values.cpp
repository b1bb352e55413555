// SPDX-License-Identifier: MIT
/// The members of ChainValues for points with non-finite coordinates.
#include <algorithm>
#include <cstring>

#include "pointsweep/verify/chain_values.h"

namespace pointsweep {
namespace {

Surroundings without_neighbors(std::span<const KnownPoint> points, std::size_t rings) {
  Surroundings around;
  for (const KnownPoint& p : points) {
    around.x.push_back(p.position.x), around.y.push_back(p.position.y), around.z.push_back(p.position.z);
    around.row.push_back(p.row);
  }
  around.ring_end.assign(rings + 1, points.size());
  around.list_begin.assign(points.size() + 1, 0);
  return around;
}

}  // namespace

/// Keeps the position, and attributes that the stage both reads and makes. All other attributes that the stage makes
/// get their value for "none".
void ChainValues::leave_unchanged(const Stage& stage, const Surroundings& points, ColumnBytes& bits,
                                  ColumnEstimates& estimates) const {
  const Contract contract = contract_of(stage.op);
  for (std::size_t m = 0; m < stage.makes.size(); ++m) {
    const std::uint16_t column = stage.makes[m];
    const Attribute& a = columns_[column];
    const auto read = std::ranges::find(contract.reads, a.name, &Attribute::name);
    const bool moves = a.name == position_attribute().name, is_read = read != contract.reads.end();
    const int before = moves ? stage.position : is_read ? stage.reads[std::size_t(read - contract.reads.begin())] : -1;
    if (before >= 0) {
      estimates[column] = estimates[static_cast<std::size_t>(before)];
      take_estimates(column, estimates, bits);
      continue;
    }
    bits[column].clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p{points.x[i], points.y[i], points.z[i]};
      bits[column].resize(bits[column].size() + a.bytes(), a.fill);
      if (moves) std::memcpy(bits[column].data() + i * a.bytes(), &p, sizeof p);
    }
    take_bits(column, bits, {}, estimates);
  }
}

/// Evaluates a stage for points with non-finite coordinates. Returns false if the stage leaves such points unchanged.
bool ChainValues::take_unplaced(const Stage& stage, const Surroundings& points, ColumnBytes& bits,
                                ColumnEstimates& estimates) const {
  for (const std::uint16_t column : stage.makes) estimates[column].clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    CloudPoint point{{{points.x[i], points.y[i], points.z[i]}, points.row[i]}, {}};
    for (const std::uint16_t column : stage.reads)
      point.reads.push_back(estimates[column][i * estimates_of(columns_[column])]);
    const auto made = stage.cloud->unplaced(point);
    if (!made) return false;
    for (std::size_t m = 0; m < stage.makes.size(); ++m) estimates[stage.makes[m]].push_back((*made)[m]);
  }
  for (const std::uint16_t column : stage.makes) take_estimates(column, estimates, bits);
  return points.size() > 0;
}

ChainResults ChainValues::evaluate_unplaced(std::span<const KnownPoint> points, RowSource& in) const {
  const Surroundings around = without_neighbors(points, rings());
  ColumnBytes bits(columns_.size());
  ColumnEstimates estimates(columns_.size());
  fetch_file_columns(around, in, bits);
  for (const FileColumn& f : file_columns_) take_bits(f.column, bits, {}, estimates);
  const std::vector<bool> certain(points.size());
  for (const Stage& stage : stages_) {
    if (stage.ring < 0) continue;
    if (stage.cloud && take_unplaced(stage, around, bits, estimates)) continue;
    if (stage.cloud || !is_pointwise(stage.op)) {
      leave_unchanged(stage, around, bits, estimates);
      continue;
    }
    if (stage.applied) apply(stage, around, bits);
    if (stage.formula)
      estimate(stage, around, certain, estimates);
    else
      for (const std::uint16_t column : stage.makes) take_bits(column, bits, {}, estimates);
  }
  return results_of(points.size(), bits, estimates);
}

}  // namespace pointsweep
