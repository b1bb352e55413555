// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/distances.h"

#include <tuple>

namespace pointsweep::formulas {

double squared_distance(const Place& p, const Place& q) {
  const auto part = [](Real a, Real b) { return static_cast<double>(a) - static_cast<double>(b); };
  const double dx = part(q.at.x, p.at.x), dy = part(q.at.y, p.at.y), dz = part(q.at.z, p.at.z);
  return (dx * dx + dy * dy) + dz * dz;
}

Estimate distance(const Place& p, const Place& q) {
  const double length = std::sqrt(squared_distance(p, q));
  const Real moved = p.error + q.error;
  return {.value = {length, 0, 0}, .error = moved > 0 ? moved + 4 * kDouble * length : 0};
}

Estimate farthest(const Place& p, std::span<const Place> neighbors) {
  Estimate result;
  for (const Place& q : neighbors) {
    const Estimate d = distance(p, q);
    if (std::isnan(d.value.x)) return d;
    result.value.x = std::max(result.value.x, d.value.x);
    result.error = std::max(result.error, d.error);
  }
  return result;
}

Estimate mean_distance(const Place& p, std::span<const Place> neighbors, bool of_open3d) {
  Estimate mean;
  const Real n = static_cast<Real>(neighbors.size()) + (of_open3d ? 1 : 0);
  for (const Place& q : neighbors) {
    const Estimate d = distance(p, q);
    mean.value.x += d.value.x / n;
    mean.error += d.error / n;
  }
  if (neighbors.empty() || !std::isfinite(mean.value.x))
    return {.value = {std::numeric_limits<Real>::quiet_NaN(), 0, 0}};
  mean.error += rounding_of_sum(neighbors.size()) * mean.value.x;
  return mean;
}

Estimate outlier(const Estimate& mean_distance, Real threshold, Real threshold_error, OutlierProgram program) {
  const Real mean = mean_distance.value.x;
  if (program == OutlierProgram::open3d && mean == 0 && mean_distance.error == 0) return {.value = {1, 0, 0}};
  if (mean_distance.is_open() || std::isnan(threshold)) return open();
  const bool at_threshold = program == OutlierProgram::pdal || program == OutlierProgram::open3d;
  if (threshold == 0 && threshold_error == 0 && mean == 0 && mean_distance.error == 0)
    return {.value = {at_threshold ? Real{1} : Real{0}, 0, 0}};
  if (std::fabs(mean - threshold) <= mean_distance.error + threshold_error) return open();
  return {.value = {!(mean <= threshold) ? Real{1} : Real{0}, 0, 0}};
}

GraphRow graph_row(const Place& p, std::span<const Place> neighbors, std::span<const std::uint64_t> rows) {
  GraphRow row;
  for (std::size_t j = 0; j < neighbors.size(); ++j)
    row.neighbors.push_back({distance(p, neighbors[j]), squared_distance(p, neighbors[j]), j});
  const auto key = [&](const GraphNeighbor& n) {
    const Vector at = is_finite(neighbors[n.index].at) ? neighbors[n.index].at : Vector{};
    const bool nowhere = std::isnan(n.distance2);
    return std::tuple(nowhere, nowhere ? 0 : n.distance2, at.x, at.y, at.z, rows[n.index]);
  };
  std::sort(row.neighbors.begin(), row.neighbors.end(),
            [&](const GraphNeighbor& a, const GraphNeighbor& b) { return key(a) < key(b); });
  for (std::size_t j = 1; j < row.neighbors.size(); ++j) {
    const Estimate &a = row.neighbors[j - 1].distance, &b = row.neighbors[j].distance;
    row.certain = row.certain && (b.value.x - a.value.x > a.error + b.error || a.error + b.error == 0);
  }
  return row;
}

}  // namespace pointsweep::formulas
