// SPDX-License-Identifier: MIT
/// Writing PCD files (Point Cloud Library), version 0.7, binary.
#pragma once

#include <memory>
#include <string>

#include "pointsweep/writer.h"

namespace pointsweep {

/// All fields with their types; scaled ones as float64. 8-bit red, green and blue are packed into `rgb`, with alpha
/// into `rgba`, as PCL has them; wider colours stay fields of their own. Normals are normal_x, normal_y, normal_z.
/// VIEWPOINT is that of the inputs if they are PCD files and agree, and the identity otherwise.
std::unique_ptr<Writer> create_pcd_writer(const OutputPlan& plan);

/// The name under which a PCD file of ours holds a field: "normal_x" for nx.
std::string pcd_field_name(const std::string& name);

}  // namespace pointsweep
