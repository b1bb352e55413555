// SPDX-License-Identifier: MIT
#include "pointsweep/operators/declare/limits_from_attributes.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

Attribute named(const std::string& name) { return scalar(name, Type::f64, "", "size of the neighbourhood"); }

/// Returns the number of neighbours allowed by the limit `value` of k.
std::size_t at_most(double value, std::size_t count) {
  if (!(value >= 1)) return 0;
  return value < static_cast<double>(count) ? static_cast<std::size_t>(value) : count;
}

/// Returns how many of the first `count` neighbours lie within `radius`. Neighbours come nearest first.
std::size_t within(double radius, const Neighborhoods& in, std::size_t i, std::size_t count) {
  if (!(radius >= 0)) return 0;
  const double radius2 = radius * radius;
  std::size_t low = 0, high = count;  // neighbours before `low` are within the radius, those from `high` on are not
  while (low < high) {
    const std::size_t middle = low + (high - low) / 2;
    in.distance2(i, middle) <= radius2 ? low = middle + 1 : high = middle;
  }
  return low;
}

}  // namespace

LimitsFromAttributes::LimitsFromAttributes(AttributeLimits limits) : limits_(std::move(limits)) {
  if (limits_.k.empty() && limits_.radius.empty())
    fail_usage("Neighbourhoods limited by attributes need the name of one, for k or for the radius.");
}

std::string LimitsFromAttributes::meaning() const {
  std::string text;
  if (!limits_.k.empty()) text += "as many as '" + limits_.k + "' says";
  if (!limits_.radius.empty()) text += (text.empty() ? "" : ", ") + ("those within '" + limits_.radius + "'");
  return text;
}

std::vector<Attribute> LimitsFromAttributes::reads() const {
  std::vector<Attribute> attributes;
  for (const std::string& name : {limits_.k, limits_.radius})
    if (!name.empty()) attributes.push_back(named(name));
  return attributes;
}

Options LimitsFromAttributes::options() const {
  Options options;
  if (!limits_.k.empty()) options.push_back({"k_from", limits_.k});
  if (!limits_.radius.empty()) options.push_back({"radius_from", limits_.radius});
  return options;
}

void LimitsFromAttributes::choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const {
  const std::size_t radius = limits_.k.empty() ? 0 : 1;  // index of the radius in reads()
  for (std::size_t i = 0; i < in.size(); ++i) {
    std::size_t count = in.count(i);
    if (!limits_.k.empty()) count = at_most(in.value<double>(0, i), count);
    if (!limits_.radius.empty()) count = within(in.value<double>(radius, i), in, i, count);
    counts[i] = static_cast<std::uint32_t>(count);
  }
}

SharedRule operators::limits_from_attributes(const AttributeLimits& limits) {
  return std::make_shared<LimitsFromAttributes>(limits);
}

}  // namespace pointsweep
