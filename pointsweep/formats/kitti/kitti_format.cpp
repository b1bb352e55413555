// SPDX-License-Identifier: MIT
#include "pointsweep/formats/kitti/kitti_format.h"

#include "pointsweep/formats/kitti/float_records.h"

namespace pointsweep {
namespace {

constexpr std::string_view kKittiExtensions[] = {".bin"};

}  // namespace

const Format kKittiFormat = {.name = "KITTI",
                             .title = "KITTI",
                             .details = "#files-without-a-signature",
                             .reads = "float32 x y z intensity, with `--format kitti`",
                             .writes = "no",
                             .extensions = kKittiExtensions,
                             .asked_for_as = "kitti",
                             .open = open_kitti};

const Format kFloatXyzFormat = {.name = "float32 records",
                                .title = "float32 records",
                                .details = "#files-without-a-signature",
                                .reads = "float32 x y z, with `--format float32-xyz`",
                                .writes = "no",
                                .extensions = {},
                                .asked_for_as = "float32-xyz",
                                .open = open_float_xyz};

}  // namespace pointsweep
