// SPDX-License-Identifier: MIT
/// Groups of points by the value of one attribute.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "pointsweep/info/value_keys.h"

namespace pointsweep {

/// Numbers the distinct values of an attribute from 0 in the order of their first occurrence. The values must be whole
/// numbers. Without an attribute all points are group 0.
class PointGroups {
 public:
  PointGroups() : keys_({0}) {}
  /// Throws UsageError if the schema lacks the attribute `by`, or if the attribute has several components.
  PointGroups(const Schema& schema, const std::string& by);

  /// Writes the group of each record; records are `stride` bytes apart. Throws UsageError for a value that is not a
  /// whole number (a real number must also be below 2^63 in magnitude), and for more groups than `most` or
  /// PointStatistics::kMostGroups. `most` is 0 in later readings of the same points, in which a new value throws Error.
  void find(std::span<const std::byte> records, std::size_t stride, std::size_t most,
            std::vector<std::uint32_t>& groups);

  std::size_t size() const { return keys_.size(); }
  /// Returns the numbers of the groups, ascending by value.
  std::vector<std::uint32_t> ascending() const;
  /// Returns the value of a group, a whole number. Must not be called without an attribute.
  AttributeValue value(std::uint32_t group) const;
  const std::string& name() const { return name_; }

 private:
  std::uint32_t number_of(std::uint64_t key, std::size_t most);
  void require_whole(std::uint64_t key) const;

  std::string name_;  ///< empty without an attribute
  std::optional<ValueKeys> values_;
  std::vector<std::uint64_t> keys_;  ///< for each group, the key of its value (ValueKeys)
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::vector<std::uint64_t> of_records_;  ///< keys of the records of the last find()
};

}  // namespace pointsweep
