// SPDX-License-Identifier: MIT
/// The shapes that can be generated, by name. A new shape is a source file, its maker below and a line in registry.cpp.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "pointsweep/shapes/shape.h"

namespace pointsweep {

std::unique_ptr<Shape> make_plane();
std::unique_ptr<Shape> make_sphere();
std::unique_ptr<Shape> make_cylinder();
std::unique_ptr<Shape> make_torus();
std::unique_ptr<Shape> make_statue();
std::unique_ptr<Shape> make_terrain();
std::unique_ptr<Shape> make_tls();
std::unique_ptr<Shape> make_volume();

/// Returns one shape of each kind, in the order of their presentation.
std::vector<std::unique_ptr<Shape>> all_shapes();
/// Throws UsageError that lists the known names.
std::unique_ptr<Shape> create_shape(std::string_view name);

}  // namespace pointsweep
