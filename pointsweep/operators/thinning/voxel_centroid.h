// SPDX-License-Identifier: MIT
/// The means of voxel(keep=centroid).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "pointsweep/in_order_operator.h"

namespace pointsweep {

/// An attribute of which means are taken. Others keep the value of the row that stays.
struct AveragedAttribute {
  Attribute made;                ///< made again, with the type and fields that it had
  std::vector<Attribute> reads;  ///< itself, or scalars of the input that are its fields
  bool is_direction = false;     ///< the mean is made a unit vector again
};

/// Returns the normals, floating-point numbers, colours and intensities among the fields of `input` and what is made;
/// but no vectors without a sign, arrays, packed or scaled fields.
std::vector<AveragedAttribute> averaged_attributes(const Schema& input, std::span<const Attribute> made);

/// Returns the work of voxel(keep=centroid), which drops all rows of a voxel but the one that keep=center would keep.
/// It gives that row the mean position, then `averaged`.
std::unique_ptr<InOrderWork> means_of_voxels(double size, const std::vector<AveragedAttribute>& averaged);

}  // namespace pointsweep
