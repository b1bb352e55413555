// SPDX-License-Identifier: MIT
/// From the words of a pipeline to the chain that runs.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/language/registry.h"

namespace pointsweep {

/// Throws UsageError, naming the place, for an unknown name, a value out of range, and a knn that is not the first
/// stage. Where knn says neither k nor a radius, the neighbourhood is that of Neighborhood::kOfOperators.
Chain build_chain(const std::vector<StageText>& stages, Facts facts);

/// Appends stages without knn to a chain; `facts` is about its cloud.
void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts);

/// The first, with the attributes to keep, which may be named as below.
Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix);

/// Builds a chain as above for a cloud, against whose attributes plan_chain() then checks it. `keep` may name made
/// attributes with the `prefix` that they have in the output, or without.
Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud,
                  const std::vector<std::string>& keep = {}, const std::string& prefix = "");

}  // namespace pointsweep
