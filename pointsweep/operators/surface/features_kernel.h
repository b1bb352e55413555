// SPDX-License-Identifier: MIT
/// Features of neighbourhoods in vector lanes: a point per lane.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// The features in the order of the attributes that Features makes. The features up to height_range are float32,
/// number_of_neighbors is u32.
enum class Feature : std::uint8_t {
  linearity,
  planarity,
  sphericity,
  omnivariance,
  anisotropy,
  eigenentropy,
  eigenvalue_sum,
  surface_variation,
  verticality,
  moment1_axis1,
  moment1_axis2,
  moment2_axis1,
  moment2_axis2,
  height_range,
  number_of_neighbors,
};
inline constexpr std::size_t kFeatures = 15;

/// The features to compute, and the columns that take them.
struct FeatureColumns {
  std::array<std::span<float>, kFeatures - 1> numbers;  ///< by Feature: as long as the batch; empty if not wanted
  EigenvalueScale eigenvalues = EigenvalueScale::raw;
  bool with_point = true;            ///< true if p_i itself is one of the points
  bool marks_without_extent = true;  ///< true if points whose neighbourhood lies at one place are degenerate
  bool marks_lines = true;           ///< true if points whose neighbourhood lies on a line are degenerate

  std::span<float> operator[](Feature f) const { return numbers[static_cast<std::size_t>(f)]; }
};

/// Computes the features of all points of the batch. Points without a result get 0 and are marked as degenerate. The
/// bits depend only on a point's neighbourhood: not on the instruction set or the batch.
void features(const Neighborhoods& in, const FeatureColumns& out, DegeneratePoints& degenerate);

}  // namespace pointsweep
