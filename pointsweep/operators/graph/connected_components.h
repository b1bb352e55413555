// SPDX-License-Identifier: MIT
/// Connected components of the graph of neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/operators.h"
#include "pointsweep/operators/kinds/connect_operator.h"

namespace pointsweep {

/// Returns whether component numbers and sizes have 32 bits in a cloud of `points` points; false for 0, which means
/// that the number of points is unknown.
bool has_short_numbers(std::uint64_t points);
/// Returns the attribute `name`, N i32 or i64: the number of the component of a point; -1 if it has none.
Attribute component_number(std::string name, std::string meaning, std::uint64_t points);
/// Returns the attribute `name`, N u32 or u64: the number of points in the component of a point.
Attribute component_size(std::string name, std::string meaning, std::uint64_t points);
/// Writes the number and the size of a component to `values`: 32 bits each if `is_short`, else 64 bits each.
void put_component(const ComponentLabel& label, bool is_short, std::byte* values);

/// Makes component and component_size. Points i and j are joined if one is a neighbour of the other, and their distance
/// does not exceed ComponentsOptions::distance, if it is set. Components are numbered from 0 by their first point: the
/// least x, then y, then z, then row.
class ConnectedComponents final : public ConnectOperator {
 public:
  /// With a distance, N_i must contain all points within it. Pipelines without such neighbourhoods are refused; C++
  /// code must ensure it. `points`: number of points of the cloud for has_short_numbers(). Throws UsageError for
  /// options outside of their ranges.
  explicit ConnectedComponents(const ComponentsOptions& options = {}, std::uint64_t points = 0);
  std::string name() const override { return "components"; }
  Contract contract() const override;
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const override;
  void put_values(const ComponentLabel& label, std::byte* values) const override;

 private:
  std::optional<double> distance_;
  std::uint64_t points_;
};

}  // namespace pointsweep
