// SPDX-License-Identifier: MIT
#include "pointsweep/formats/vtk/vtk_format.h"

#include "pointsweep/formats/vtk/vtk_layout.h"
#include "pointsweep/formats/vtk/vtk_reader.h"

namespace pointsweep {
namespace {

constexpr std::string_view kVtkExtensions[] = {".vtk"};

}  // namespace

const Format kVtkFormat = {.name = "VTK",
                           .title = "VTK legacy",
                           .details = "#vtk",
                           .reads = "points of POLYDATA, UNSTRUCTURED_GRID, STRUCTURED_GRID; ascii, binary",
                           .writes = "no",
                           .extensions = kVtkExtensions,
                           .is = starts_as_vtk,
                           .open = open_vtk};

}  // namespace pointsweep
