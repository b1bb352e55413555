// SPDX-License-Identifier: MIT
/// Lengths that operators take and make, in clouds whose coordinate system says what its numbers are.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/declare/declaration.h"

namespace pointsweep {

/// Returns the facts about the cloud that the construction of stages depends on.
Facts facts_of(const InputCloud& cloud);

/// The declarations of options for a cloud whose unit is so many metres long: defaults that are lengths, which are
/// declared in metres, in that unit.
std::vector<OptionDeclaration> in_unit(std::vector<OptionDeclaration> options, double metres_per_unit);

/// Throws UsageError if the coordinates are degrees, of which no distance can be made, and a stage looks at distances.
/// CloudOptions::ignore_crs allows it.
void require_lengths(const InputCloud& cloud, const Chain& chain);

/// Returns one sentence for each stage with defaults that are lengths, where the coordinate system of the cloud has
/// another unit than the metre, or does not state its unit: a code of the EPSG registry alone does not.
std::vector<std::string> notes_on_defaults(const InputCloud& cloud, const Chain& chain);

}  // namespace pointsweep
