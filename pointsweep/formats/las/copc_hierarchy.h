// SPDX-License-Identifier: MIT
/// The hierarchy of a COPC file: which chunk of points is which node of an octree, and so in which box (COPC 1.0,
/// https://copc.io).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/las/laz_points.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

/// Length of the content of the info VLR.
inline constexpr std::uint64_t kCopcInfoBytes = 160;

/// By chunk of `points` the box of the node that the hierarchy says it is: a hint, not to be trusted. Empty where the
/// hierarchy contradicts itself, the chunk table or the file: then `why_not` says why, as the end of a sentence.
/// `info`: the byte where the content of the info VLR begins. Reads at most as many bytes as the file has.
std::vector<Box> read_copc_boxes(const InputFile& file, std::uint64_t info, const LazPoints& points,
                                 std::string& why_not);

}  // namespace pointsweep
