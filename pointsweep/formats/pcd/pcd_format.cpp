// SPDX-License-Identifier: MIT
#include "pointsweep/formats/pcd/pcd_format.h"

#include "pointsweep/formats/format.h"

namespace pointsweep {
namespace {

constexpr std::string_view kPcdExtensions[] = {".pcd"};

}  // namespace

const Format kPcdFormat = {.name = "PCD",
                           .title = "PCD",
                           .details = "#pcd",
                           .reads = "ascii, binary, binary_compressed; versions .5 to 0.7",
                           .writes = "binary, version 0.7",
                           .extensions = kPcdExtensions,
                           .is = starts_as_pcd,
                           .open = open_pcd,
                           .create = create_pcd_writer,
                           .holds_provenance = true,
                           .is_sequential = true,
                           .stored_name = pcd_field_name};

}  // namespace pointsweep
