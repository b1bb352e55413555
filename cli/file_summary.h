// SPDX-License-Identifier: MIT
/// What a look at every point of a file tells.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// Values of one field of the records, all components together.
struct FieldRange {
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;  ///< of the finite ones; lo > hi: there is none
  std::uint64_t nonfinite = 0;                                    ///< NaN and infinite values
};

struct FileSummary {
  Box bounds;                                       ///< of the finite points
  std::uint64_t nonfinite = 0;                      ///< points with a NaN or infinite coordinate
  std::array<bool, 3> ascending{true, true, true};  ///< no finite point lies below the one before it along x, y, z
  std::array<bool, 3> descending{true, true, true};
  std::vector<FieldRange> ranges;            ///< of the fields of the schema
  std::array<std::uint64_t, 256> classes{};  ///< points of each class, if there is a field `classification`
  std::array<std::uint64_t, 16> returns{};   ///< points of each return number, if there is such a field
  std::uint64_t returns_beyond = 0;  ///< points whose return number is above their number of returns
  double area = 0, cell_side = 0;            ///< of the occupied cells in x and y (PlanArea)
  std::vector<double> nearest;               ///< distances to the nearest neighbours of a sample, ascending
  bool has_classes = false, has_returns = false;

  /// Finite points for each unit of occupied area; none without area.
  std::optional<double> density(std::uint64_t points) const;
  /// The median of `nearest`.
  std::optional<double> spacing() const;
};

enum class Spacing : bool { skip, measure };

/// Reads all points in sequence, in pieces, twice if the spacing is measured; calls `progress(done, total)` after each.
/// Memory: about 10 MB.
FileSummary summarize(Reader& reader, Spacing spacing,
                      const std::function<void(std::uint64_t done, std::uint64_t total)>& progress);

/// Several lines for people.
std::string to_text(const FileInfo& info, const FileSummary& summary);
/// "x y z float32, intensity uint16".
std::string attribute_text(const Schema& schema);
/// The lines on points and bounds alone.
std::string to_text(std::uint64_t points, const Box& bounds);

/// The object of one file; docs/info.md lists its keys.
nlohmann::ordered_json to_json(const FileInfo& info, const FileSummary& summary);
nlohmann::ordered_json to_json(const Box& bounds);

}  // namespace pointsweep
