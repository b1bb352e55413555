// SPDX-License-Identifier: MIT
/// The contents of a legacy VTK file, and their places.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// One row of `components` values for each point.
struct VtkArray {
  std::string name;
  Type type = Type::f32;
  std::uint32_t components = 1;
  bool shares = false;                     ///< numbers of text that are shares of 255
  std::uint64_t begin = 0;                 ///< byte of the first value in a binary file
  std::vector<std::uint64_t> places = {};  ///< in text: bytes of rows 0, VtkLayout::kRowsPerPlace, ...
};

struct VtkLayout {
  static constexpr std::uint64_t kRowsPerPlace = 16384;

  bool text = false;
  std::string dataset;                ///< "POLYDATA"
  std::uint64_t count = 0;            ///< points
  std::vector<VtkArray> arrays;       ///< the positions, then attributes of points
  std::uint64_t cells = 0;            ///< without single vertices
  std::vector<std::string> left_out;  ///< names of arrays of points that cannot be kept
};

/// Returns whether a file that begins with `head` is a legacy VTK file.
bool starts_as_vtk(std::string_view head);

/// Reads all of a text file, and of a binary one the lines between arrays. Throws Error with the place that is wrong.
VtkLayout read_vtk_layout(const InputFile& file);

}  // namespace pointsweep
