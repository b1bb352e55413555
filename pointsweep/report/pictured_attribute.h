// SPDX-License-Identifier: MIT
/// The choice of the result of a run that its picture shows.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The colouring, as PointColor takes it, that shows what the last operator of a chain computed: curvature, plain
/// (light and shade by the normals) after normals and splats, for other operators the first number that was made
/// (made_numbers). Operators without a visible result are passed over. Empty: no operator has one in the output.
std::string pictured_attribute(std::span<const std::string> operators, const Schema& input, const Schema& output);

/// Returns the fields of the output that the operators have made: fields that the input does not have, and fields of
/// the input that an operator makes again.
std::vector<std::string> made_numbers(std::span<const std::string> operators, const Schema& input,
                                      const Schema& output);

}  // namespace pointsweep
