// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/made_values.h"

#include <fmt/format.h>

#include "pointsweep/verify/rows/file_pairs.h"

namespace pointsweep {

void MadeValues::keep(const std::vector<bool>& told) {
  std::erase_if(values_, [&](const NumberedValue& value) { return !told[value.first]; });
}

std::uint64_t MadeValues::open_values(const formulas::Estimate* estimates) const {
  std::uint64_t open = 0;
  for (const auto& [number, value] : values_) open += estimates[number].is_open();
  return open;
}

std::optional<std::string> MadeValues::difference_at(std::uint64_t place, std::uint64_t row, const std::byte* result,
                                                     const formulas::Estimate* estimates, const std::byte* record) {
  for (const auto& [number, value] : in_file_of(place))
    if (const auto component = value.wrong_component(estimates[number], result, record))
      return fmt::format("row {}{}: {}", place, place == row ? "" : fmt::format(" (row {} of the input)", row),
                         value.difference(*component, estimates[number], result, record));
  return std::nullopt;
}

std::span<const MadeValues::NumberedValue> MadeValues::in_file_of(std::uint64_t place) {
  if (files_.size() == 1) return values_;
  if (const std::size_t file = file_of_row(files_, place); file_ != file) {
    file_ = file, in_file_.clear();
    for (const auto& [number, value] : values_) in_file_.emplace_back(number, value.in_file(*files_[file].schema));
  }
  return in_file_;
}

}  // namespace pointsweep
