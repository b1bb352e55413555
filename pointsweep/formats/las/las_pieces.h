// SPDX-License-Identifier: MIT
/// The parts of a LAS output around its points: VLRs that are made, and the pieces of the input.
#pragma once

#include "pointsweep/formats/las/las_extra_bytes.h"
#include "pointsweep/formats/las/las_layout.h"

namespace pointsweep {

/// The descriptions of the records that VLRs hold.
struct LasDescriptions {
  ExtraBytesVlr extra_bytes;
  bool extended = false;       ///< extra_bytes has to be written
  bool keeps_records = false;  ///< records begin with those of the input
  Crs added_crs;               ///< to be stated beside what the VLRs of the input state
};

/// Sets pieces and VLRs of the layout, and what the header says of them. `input`: null unless the input is LAS. The
/// record length of the header is that of the output.
void place_las_pieces(const OutputPlan& plan, LasPoints points, const LasExtras* input,
                      const LasDescriptions& descriptions, LasLayout& layout);

}  // namespace pointsweep
