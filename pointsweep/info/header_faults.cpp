// SPDX-License-Identifier: MIT
#include "pointsweep/info/header_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

/// Returns the largest difference between a bound in the header and the bound of the points that rounding explains:
/// half a step of the grid plus the rounding of decimal numbers.
double tolerance_of(const Field& coordinate, double bound) {
  return 0.5 * coordinate.scale + 4 * std::abs(bound) * 0x1p-52;
}

void add_wrong_bounds(const FileInfo& info, const Box& points, std::vector<std::string>& faults) {
  if (points.empty()) return;
  const Box& stated = info.claims->bounds;
  const PositionFields fields = position_fields(info.schema, info.path.string());
  const Field* const coordinates[] = {&fields.x, &fields.y, &fields.z};
  for (int axis = 0; axis < 3; ++axis) {
    const auto agree = [&](double a, double b) { return std::abs(a - b) <= tolerance_of(*coordinates[axis], b); };
    if (agree(stated.lo[axis], points.lo[axis]) && agree(stated.hi[axis], points.hi[axis])) continue;
    faults.push_back(fmt::format("the header states {} from {:.15g} to {:.15g}; the points have {:.15g} to {:.15g}.",
                                 "xyz"[axis], stated.lo[axis], stated.hi[axis], points.lo[axis], points.hi[axis]));
  }
}

void add_wrong_counts(const FileSummary& summary, std::vector<std::string>& faults) {
  if (!summary.has_returns) return;
  const std::vector<std::uint64_t>& stated = summary.info.claims->returns;
  std::string header, points;
  for (std::size_t r = 1; r <= stated.size() && r < summary.returns.size(); ++r) {
    if (stated[r - 1] == summary.returns[r]) continue;
    const char* const comma = header.empty() ? "" : ", ";
    header += fmt::format("{}{}: {}", comma, r, stated[r - 1]);
    points += fmt::format("{}{}: {}", comma, r, summary.returns[r]);
  }
  if (!header.empty())
    faults.push_back(fmt::format("the header counts points by return as {}; there are {}.", header, points));
}

}  // namespace

std::vector<std::string> header_faults(const FileSummary& summary) {
  const FileInfo& info = summary.info;
  std::vector<std::string> faults;
  if (info.claims) {
    add_wrong_bounds(info, summary.bounds, faults);
    add_wrong_counts(summary, faults);
  }
  if (summary.returns_beyond > 0)
    faults.push_back(fmt::format("{} {} a return number above the number of returns.", summary.returns_beyond,
                                 summary.returns_beyond == 1 ? "point has" : "points have"));
  return faults;
}

}  // namespace pointsweep
