// SPDX-License-Identifier: MIT
/// Sentences about the files of a run: the warnings of many writers without repetition, how many outputs are complete,
/// and the rounding of coordinates that an output stores as float32.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Joins warnings that differ only in the file name at their beginning.
class OutputWarnings {
 public:
  void add(const std::vector<std::string>& warnings, const std::filesystem::path& output);
  /// Returns each distinct warning with the name of one file and the number of other files that share it.
  std::vector<std::string> sentences() const;

 private:
  struct Warning {
    std::string first;
    std::size_t others = 0;
  };
  std::map<std::string, Warning> warnings_;  ///< keys: texts after the name of the file
};

/// Returns a sentence such as " 3 of 5 outputs are complete and stay.", to append to an error; empty if none is
/// complete.
std::string complete_outputs_text(std::size_t complete, std::size_t all);

/// Finds by how much the coordinates of the records of an output may have been rounded to float32.
class FloatRounding {
 public:
  /// `input`: fields of the input. `output`: fields of the records. Ignores all records unless the output has float32
  /// coordinates, and the input has scaled coordinates or another type, or a stage moves the points.
  FloatRounding(const Schema& input, const std::vector<Attribute>& made, const Schema& output);

  /// Takes whole records of the output.
  void see(std::span<const std::byte> records);
  /// Returns "x, y and z are stored as float32, which rounds them by at most 0.25; ...". The bound is half a step of
  /// float32 at the coordinate farthest from 0. The sentence proposes a translation if that makes the bound at least 16
  /// times smaller. Empty if records are ignored, or if all finite coordinates are 0.
  std::string sentence() const;

 private:
  std::optional<PositionFields> narrowed_;
  std::size_t stride_;
  Box box_;  ///< box of the finite coordinates
};

}  // namespace pointsweep
