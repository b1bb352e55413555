// SPDX-License-Identifier: MIT
/// A summary of a file as lines for people.
#pragma once

#include <cstdint>
#include <string>

#include "pointsweep/info.h"

namespace pointsweep {

std::string to_text(const FileSummary& summary);
/// "x y z float32, intensity uint16".
std::string attribute_text(const Schema& schema);
/// The lines on points and bounds alone.
std::string to_text(std::uint64_t points, const Box& bounds);

}  // namespace pointsweep
