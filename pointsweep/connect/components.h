// SPDX-License-Identifier: MIT
/// Connected components of a graph of points and edges in buckets: their numbers, sizes and signs (ForestEdge).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/connect/forest_log.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

struct ComponentsSetup {
  const VoteRule* votes = nullptr;  ///< null if components need no votes; must outlive the components
  MakeScratch make_scratch;
  std::uint64_t memory_bytes = 0;  ///< memory for sorting components
  /// Receives the number of points done so far. The count runs twice: while the components are found, and in
  /// for_each_point(). May throw to end the work.
  std::function<void(std::uint64_t points)> progress;
};

class Components {
 public:
  /// Finds the components. `setup` must outlive this object.
  Components(const EdgeBuckets& buckets, const ComponentsSetup& setup);

  /// Calls use(row, label) once for each point. The components that get a number (VoteRule::counts()) are numbered from
  /// 0 in the order of their first points.
  void for_each_point(const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use) const;
  /// Calls `use` with each component that gets a number and the result of its votes, in the order of first points.
  void for_each_component(
      const std::function<void(const FinishedComponent& component, const std::byte* result)>& use) const;
  /// Returns the number of all components, with or without a number.
  std::uint64_t count() const { return count_; }
  /// Returns the bytes of the log of the forest in the temporary folder.
  std::uint64_t log_bytes() const { return log_.bytes(); }

 private:
  bool turns(const std::byte* component) const;

  const ComponentsSetup& setup_;
  ForestLog log_;
  std::uint64_t count_ = 0;
};

}  // namespace pointsweep
