// SPDX-License-Identifier: MIT
/// The sizes of neighbourhoods that a rule chooses for a cloud in memory.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "tests/support/in_core.h"

namespace pointsweep {

/// An operator whose attribute is the size that a rule chooses.
class Choice final : public LocalOperator {
 public:
  explicit Choice(const NeighborhoodRule& rule) : rule_(rule) {}
  std::string name() const override { return "choice"; }
  Contract contract() const override {
    return {rule_.reads(), {}, {scalar("chosen", Type::u32, "1", "neighbours kept")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override { rule_.choose(in, out.column<std::uint32_t>(0)); }

 private:
  const NeighborhoodRule& rule_;
};

/// Returns the size that the rule chooses for each point. `attributes`: the values of each attribute that the rule
/// reads, one per point.
inline std::vector<std::uint32_t> chosen(const NeighborhoodRule& rule, std::span<const Vec3> points,
                                         const std::vector<std::vector<std::uint32_t>>& lists,
                                         const std::vector<std::vector<double>>& attributes = {},
                                         std::size_t cell_points = kCellCapacity) {
  std::vector<std::vector<std::byte>> reads;
  for (const std::vector<double>& values : attributes) {
    const auto bytes = std::as_bytes(std::span(values));
    reads.emplace_back(bytes.begin(), bytes.end());
  }
  return InCoreCloud(points, lists, cell_points).apply(Choice(rule), reads).column<std::uint32_t>(0);
}

}  // namespace pointsweep
