// SPDX-License-Identifier: MIT
#include "pointsweep/formats/mesh/mesh_formats.h"

#include "pointsweep/formats/mesh/obj_reader.h"
#include "pointsweep/formats/mesh/off_reader.h"

namespace pointsweep {
namespace {

constexpr std::string_view kOffExtensions[] = {".off"}, kObjExtensions[] = {".obj"};

}  // namespace

const Format kOffFormat = {.name = "OFF",
                           .title = "OFF",
                           .details = "#off-and-obj",
                           .reads = "vertices of text files, with normals and colours",
                           .writes = "no",
                           .extensions = kOffExtensions,
                           .is = starts_as_off,
                           .open = open_off};

const Format kObjFormat = {.name = "OBJ",
                           .title = "OBJ",
                           .details = "#off-and-obj",
                           .reads = "vertices, with normals and colours",
                           .writes = "no",
                           .extensions = kObjExtensions,
                           .is = starts_as_obj,
                           .open = open_obj};

}  // namespace pointsweep
