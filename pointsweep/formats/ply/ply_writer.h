// SPDX-License-Identifier: MIT
/// Writing PLY files, binary little-endian.
#pragma once

#include <memory>

#include "pointsweep/writer.h"

namespace pointsweep {

/// One element `vertex` with a property for each component of each field, in the order of the plan, under its own name
/// and type. Scaled fields become `double`, bit fields the smallest unsigned type that holds them. PLY has no 64-bit
/// integers: from an input that was PLY and used them anyway (`int64`) they are kept so, otherwise they become
/// `double`, and one that a double cannot hold exactly is an Error.
/// The coordinate reference system becomes comments: see ply_comments.h.
std::unique_ptr<Writer> create_ply_writer(const OutputPlan& plan);

}  // namespace pointsweep
