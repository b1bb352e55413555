// SPDX-License-Identifier: MIT
/// Converts default lengths of operators to the unit of a cloud, and refuses distances in clouds whose unit is the
/// degree.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {

/// Returns the facts about the cloud that the construction of stages depends on.
Facts facts_of(const InputCloud& cloud);

/// Returns the declarations for a cloud whose unit has `metres_per_unit` metres: default lengths, declared in metres,
/// are converted to that unit.
std::vector<OptionDeclaration> in_unit(std::vector<OptionDeclaration> options, double metres_per_unit);

/// Throws UsageError if the coordinates are degrees and a stage uses distances, unless CloudOptions::ignore_crs is set.
void require_lengths(const InputCloud& cloud, const Chain& chain);

/// Returns one sentence for each stage with default lengths if the coordinate reference system of the cloud has a unit
/// other than the metre, or states no unit; a code of the EPSG registry alone does not state one. Returns nothing for a
/// cloud without such a system.
std::vector<std::string> notes_on_defaults(const InputCloud& cloud, const Chain& chain);

}  // namespace pointsweep
