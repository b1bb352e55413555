// SPDX-License-Identifier: MIT
#include "pointsweep/info/point_groups.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/info/value_statistics.h"

namespace pointsweep {

PointGroups::PointGroups(const Schema& schema, const std::string& by) {
  const Field& field = named_field(schema, by, "--by");
  if (field.count != 1) fail_usage("--by: '{}' has {} components; name an attribute that has one.", by, field.count);
  name_ = field.name;
  values_.emplace(field);
}

void PointGroups::find(std::span<const std::byte> records, std::size_t stride, std::size_t most,
                       std::vector<std::uint32_t>& groups) {
  groups.assign(records.size() / stride, 0);
  if (!values_) return;
  values_->find(records, stride, of_records_);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const bool as_before = i > 0 && of_records_[i] == of_records_[i - 1];
    groups[i] = as_before ? groups[i - 1] : number_of(of_records_[i], most);
  }
}

std::uint32_t PointGroups::number_of(std::uint64_t key, std::size_t most) {
  const auto [known, is_new] = numbers_.try_emplace(key, static_cast<std::uint32_t>(keys_.size()));
  if (!is_new) return known->second;
  if (most == 0) fail_of_changed_points();
  require_whole(key);
  if (keys_.size() >= PointStatistics::kMostGroups)
    fail_usage("--by: '{}' has more than {} values; choose an attribute that has fewer values.", name_,
               PointStatistics::kMostGroups);
  if (keys_.size() >= most)
    fail_usage(
        "--by: '{}' has more than {} values, for which statistics of so many attributes take too much memory; name "
        "fewer attributes with --keep and --histogram, or choose an attribute that has fewer values.",
        name_, most);
  keys_.push_back(key);
  return known->second;
}

/// Throws UsageError for a value that is not a whole number, or is a real number of 2^63 or more in magnitude. The
/// values decide and not the type of the field, because text files have float64 fields even for classes.
void PointGroups::require_whole(std::uint64_t key) const {
  if (values_->is_whole()) return;
  const double value = values_->real(key);
  if (value != std::floor(value) || !(std::abs(value) < 0x1p63))
    fail_usage(
        "--by: '{0}' has the value {1}, and points are grouped by whole numbers; make whole numbers of it first, e.g. "
        "with the pipeline 'set(part = floor({0}), as=int32)', and group by these.",
        name_, value);
}

AttributeValue PointGroups::value(std::uint32_t group) const {
  if (!values_->is_whole()) return static_cast<std::int64_t>(values_->real(keys_[group]));
  return values_->value(keys_[group]);
}

std::vector<std::uint32_t> PointGroups::ascending() const {
  std::vector<std::uint32_t> groups(keys_.size());
  std::iota(groups.begin(), groups.end(), 0u);
  std::ranges::sort(groups, {}, [&](std::uint32_t group) { return keys_[group]; });
  return groups;
}

}  // namespace pointsweep
