// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/file_pairs.h"

#include <fmt/format.h>

#include <algorithm>

namespace pointsweep {

std::size_t file_of_row(std::span<const FileOfRows> files, std::uint64_t row) {
  return static_cast<std::size_t>(std::ranges::upper_bound(files, row, {}, &FileOfRows::first) - files.begin()) - 1;
}

FilePairs::FilePairs(const RowSource& in, const RowSource& out, bool in_any_order, std::vector<FieldPair> pairs)
    : pairs_(std::move(pairs)),
      in_{in.files(), in.count()},
      out_{out.files(), out.count()},
      by_file_(!in_any_order && in.files().size() == out.files().size() && in.files().size() > 1) {}

std::span<const FieldPair> FilePairs::of(Side& side, std::uint64_t row) {
  if (!by_file_) return pairs_;
  if (row >= side.first && row < side.end) return side.pairs;
  const std::size_t file = file_of_row(side.files, row);
  side.first = side.files[file].first;
  side.end = file + 1 < side.files.size() ? side.files[file + 1].first : side.count;
  side.pairs.clear();
  for (const FieldPair& pair : pairs_)
    side.pairs.push_back(pair.in_files(in_.files[file].schema, out_.files[file].schema));
  return side.pairs;
}

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
