// SPDX-License-Identifier: MIT
/// The mean positions and mean attributes of the points of each voxel, for voxel(keep=centroid).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pointsweep/in_order_operator.h"

namespace pointsweep {

/// An attribute that is averaged. Other attributes keep the value of the kept row.
struct AveragedAttribute {
  Attribute made;                ///< the mean, with the type and fields of the averaged attribute
  std::vector<Attribute> reads;  ///< the averaged attribute, or scalars of the input that are its fields
  bool is_direction = false;     ///< true if the mean is normalised to a unit vector
};

/// Returns the attributes to average: normals, floating-point numbers, colours and intensities among the fields of
/// `input` and the made ones; but no vectors of arbitrary sign, arrays, packed or scaled fields.
std::vector<AveragedAttribute> averaged_attributes(const Schema& input, std::span<const Attribute> made);

/// Returns the work of voxel(keep=centroid). It drops all rows of a voxel except the one that keep=center would keep,
/// which gets the mean position and means of `averaged`.
std::unique_ptr<InOrderWork> means_of_voxels(double size, const std::vector<AveragedAttribute>& averaged);

}  // namespace pointsweep
