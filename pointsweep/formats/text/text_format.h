// SPDX-License-Identifier: MIT
/// Text as the list of formats has it.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kTextFormat;
/// Text with commas and a line of names, which most programs read only if it has no comments.
extern const Format kPtsFormat;
extern const Format kCsvFormat;

}  // namespace pointsweep
