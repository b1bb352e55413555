// SPDX-License-Identifier: MIT
#include "pointsweep/formats/ptx/ptx_format.h"

#include "pointsweep/formats/ptx/ptx_layout.h"
#include "pointsweep/formats/ptx/ptx_reader.h"

namespace pointsweep {
namespace {

constexpr std::string_view kPtxExtensions[] = {".ptx"};

}  // namespace

const Format kPtxFormat = {.name = "PTX",
                           .title = "PTX",
                           .details = "#ptx-and-pts",
                           .reads = "all scans as one cloud, transformations applied",
                           .writes = "no",
                           .extensions = kPtxExtensions,
                           .is = starts_as_ptx,
                           .open = open_ptx};

}  // namespace pointsweep
