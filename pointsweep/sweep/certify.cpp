// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/certify.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pointsweep {
namespace {

/// Returns the `share` quantile of the reaches of a cell's points, from at most 128 of the points.
double reach_of_most(const std::vector<double>& reach2, double share) {
  constexpr std::size_t kMost = 128;
  std::vector<double> sample;
  sample.reserve(kMost);
  const std::size_t step = (reach2.size() + kMost - 1) / kMost;
  for (std::size_t i = 0; i < reach2.size(); i += step) sample.push_back(reach2[i]);
  const auto at = sample.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(sample.size() - 1) * share);
  std::nth_element(sample.begin(), at, sample.end());
  return std::sqrt(*at);
}

/// The quantile of the reaches of a cell's points that counts as the reach of the cell. The reach of a cell decides how
/// long the cell stays in the window.
constexpr double kCountedShare = 0.9;

/// Makes the cell wait, with a better estimate of its reach than its density gave.
void wait(WindowCell& cell, const std::vector<double>& reach2, const Frontier& frontier) {
  const double needed = reach_of_most(reach2, 1 - 1.0 / kStragglers);
  cell.wait_reach = std::max(cell.wait_reach, std::isfinite(needed) ? needed : 0);
  cell.wait_for_slabs = frontier.slabs_read() + 1;
  for (std::uint32_t i = 0; i < cell.cell.size(); ++i) {
    double& reach = cell.leaf_reach[i / kLeafCapacity];
    if (std::isfinite(reach2[i])) reach = std::max(reach, std::sqrt(reach2[i]));
  }
}

void leave_out(WindowCell& cell, std::uint32_t i) {
  if (cell.deferred.empty()) cell.deferred.resize(cell.cell.size(), 0);
  cell.deferred[i] = 1;
}

void leave_unresolved(WindowCell& cell, std::uint32_t i, double reach2) {
  leave_out(cell, i);
  cell.unresolved.push_back({cell.cell.row[i], cell.steps_done, reach2});
}

void defer(WindowCell& cell, std::uint32_t i, double reach2) {
  leave_out(cell, i);
  cell.left_to_recall.push_back(
      {cell.cell.position(i), cell.cell.row[i], cell.slab, cell.index_in_slab[i], reach2, cell.steps_done});
}

/// Returns the squared distance at which the neighbourhood of list `i`, of a point at `p`, ends; infinite where the
/// list does not tell.
double end_of_list(const Neighborhood& what, Vec3 p, const CellNeighbors& lists, std::uint32_t i,
                   const Window& window) {
  if (what.rule || lists.begin[i + 1] - lists.begin[i] < what.k) return Box::kInf;
  const NeighborRef last = lists.refs[lists.begin[i + 1] - 1];
  return distance2(p, window.at(slot_of(last)).cell.position(index_of(last)));
}

}  // namespace

bool certify(WindowCell& cell, const Frontier& frontier, Worker& worker) {
  const std::vector<double>& reach2s = worker.reach2;
  const Box& box = cell.cell.box;
  const double most = *std::max_element(reach2s.begin(), reach2s.end());
  const bool ahead = frontier.unread_within(box, most), outside = frontier.outside_within(box, most);
  frontier.dropped_near(box, most, worker.dropped);
  std::vector<std::uint32_t> early, behind, unresolved;
  for (std::uint32_t i = 0; (ahead || outside || !worker.dropped.empty()) && i < cell.cell.size(); ++i) {
    const Vec3 p = cell.cell.position(i);
    const double reach2 = reach2s[i];
    if (ahead && frontier.unread_within(p, reach2)) {
      early.push_back(i);
    } else if (std::any_of(worker.dropped.begin(), worker.dropped.end(),
                           [&](const Box& b) { return distance2(b, p) <= reach2; })) {
      behind.push_back(i);
    } else if (outside && frontier.outside_within(p, reach2)) {
      unresolved.push_back(i);
    }
  }
  if (early.size() * kStragglers > cell.cell.size()) {
    wait(cell, reach2s, frontier);
    return false;
  }
  for (const std::uint32_t i : early) defer(cell, i, reach2s[i]);
  for (const std::uint32_t i : behind) defer(cell, i, reach2s[i]);
  for (const std::uint32_t i : unresolved) leave_unresolved(cell, i, reach2s[i]);
  cell.certified = cell.cell.size() - early.size() - behind.size() - unresolved.size();
  cell.reach = std::min(reach_of_most(reach2s, kCountedShare), cell.cell.box.diagonal() + cell.wait_reach);
  return true;
}

void defer_dependents(const Neighborhood& what, WindowCell& cell, std::uint32_t first, const CellNeighbors& lists,
                      const Window& window) {
  const auto any = std::any_of(cell.refers_to.begin(), cell.refers_to.end(),
                               [&](std::uint32_t slot) { return !window.at(slot).deferred_before.empty(); });
  if (!any) return;
  std::vector<std::pair<std::uint32_t, double>> follow;  // points to defer, with their squared reach
  for (std::uint32_t i = 0; i < lists.size(); ++i) {
    if (cell.is_deferred(first + i)) continue;
    for (std::uint32_t j = lists.begin[i]; j < lists.begin[i + 1]; ++j) {
      const NeighborRef ref = lists.refs[j];
      if (window.at(slot_of(ref)).was_deferred(index_of(ref))) {
        follow.emplace_back(first + i, end_of_list(what, cell.cell.position(first + i), lists, i, window));
        break;
      }
    }
  }
  cell.certified -= follow.size();
  for (const auto& [i, reach2] : follow) defer(cell, i, reach2);
}

}  // namespace pointsweep
