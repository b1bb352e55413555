// SPDX-License-Identifier: MIT
/// The list of all operators of the library, a check of neighbourhoods, and the units of made attributes. The source of
/// the operator `name` defines name_declaration().
#pragma once

#include <cstddef>
#include <string>

#include "pointsweep/program/declaration.h"

// clang-format off
/// Calls X(name) for each operator, in the order of help and documentation.
#define POINTSWEEP_OPERATORS(X) \
  X(normals) X(curvature) X(splats) X(fair) X(features) X(neighborhood_size) X(where) X(crop) \
  X(set) X(drop) X(transform) X(sor) X(denoise) X(ror) X(lof) X(density) \
  X(statistics) X(unique) X(head) X(decimate) X(sample) X(parts) X(voxel) X(poisson) \
  X(simplify) X(level) X(ground) X(height) X(color) X(distance_to) X(m3c2) X(take) \
  X(components) X(dbscan) X(segments) X(orient) X(reneighbor) X(resort)
// clang-format on

namespace pointsweep {

#define POINTSWEEP_DECLARE(name) OperatorDeclaration name##_declaration();
POINTSWEEP_OPERATORS(POINTSWEEP_DECLARE)
#undef POINTSWEEP_DECLARE

/// Throws UsageError, beginning with `where`, unless the neighbourhoods in effect contain the `k` nearest points within
/// `radius`, or all points within `radius` if k is Neighborhood::kUnlimited. Accepts neighbourhoods that are unknown. A
/// k that is the default of the operators suffices; a neighbourhood with a rule never does. For operators that count
/// neighbours within a distance.
void require_complete_lists(const Facts& facts, std::size_t k, double radius, const std::string& where);

/// Returns the unit of the single-valued attribute that `name` means, in any spelling, among the attributes that
/// `transform` knows by their names; "1" for all other names.
std::string unit_of_made(const std::string& name);

}  // namespace pointsweep
