// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/made_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pointsweep/formats/field_names.h"

namespace pointsweep {

using formulas::Estimate;
using formulas::Real;
using formulas::Vector;

namespace {

/// Returns whether the value is an overlap flag that the LAS writer has set because the input has class 12. Old point
/// formats have no such flag.
bool is_overlap_by_class(const Field& field, const Schema& schema, const std::byte* record) {
  const auto classification = schema.find("classification");
  return field.name == "overlap" && classification && value_of(schema.fields[*classification], record) == 12;
}

/// Returns whether the value is the state by which an E57 file marks a point whose coordinates are not finite.
bool is_state_of_nan(const Field& field, const PositionFields& position, const std::byte* record) {
  return field.name == "invalid_state" && value_of(field, record) == 2 && !is_finite(position_in(position, record));
}

bool is_exact(const Estimate& e) { return e.error == 0 && !e.either_sign && !e.may_be_undefined; }

bool are_equal(const FieldPair& pair, const std::byte* result, const std::byte* record) {
  return pair.expected(result) == pair.found(record) ||
         (std::isnan(pair.expected_value(result)) && std::isnan(pair.found_value(record)));
}

}  // namespace

Schema schema_of_made(const std::vector<Attribute>& made, const std::string& prefix) {
  Schema schema;
  for (const Attribute& a : made)
    for (const std::string& field : a.fields)
      schema.append(a.name == position_attribute().name ? field : prefix + field, a.type);
  return schema;
}

bool is_field_of(const Schema& schema, const std::string& name) {
  const auto copy = [&](const Field& field) { return name == fmt::format("{}_{}", field.name, name_of(field.type)); };
  const std::vector<std::string> columns = column_names(schema);
  return schema.find(name) || schema.find(library_name_of(name)) || std::ranges::find(columns, name) != columns.end() ||
         std::ranges::any_of(schema.fields, copy);
}

std::vector<std::string> unfilled_fields(RowSource& out, const std::vector<std::string>& names, OwnField own_field) {
  std::vector<std::pair<Field, double>> own;
  for (const Field& field : out.schema().fields)
    if (const auto value = own_field != nullptr ? own_field(field.name) : std::nullopt)
      if (std::ranges::find(names, field.name) != names.end()) own.emplace_back(field, *value);
  if (own.empty()) return {};
  const PositionFields position = position_fields(out.schema(), out.name());
  for (std::uint64_t first = 0; first < out.count() && !own.empty(); first += out.block_rows()) {
    const std::span<const std::byte> records = out.read_block(first);
    for (std::size_t at = 0; at < records.size(); at += out.schema().stride)
      std::erase_if(own, [&](const auto& one) {
        const std::byte* const record = &records[at];
        return value_of(one.first, record) != one.second && !is_overlap_by_class(one.first, out.schema(), record) &&
               !is_state_of_nan(one.first, position, record);
      });
  }
  std::vector<std::string> unfilled;
  for (const auto& [field, value] : own) unfilled.push_back(field.name);
  return unfilled;
}

MadeValue MadeValue::in_file(const Schema& to) const {
  MadeValue value = *this;
  for (auto& pair : value.pairs_)
    if (pair) pair = pair->in_files(nullptr, &to);
  return value;
}

Real MadeValue::distance_to(Vector expected, const std::byte* record) const {
  Real sum2 = 0;
  for (std::size_t c = 0; c < pairs_.size(); ++c) {
    if (!pairs_[c]) continue;
    const Real wanted = expected[c], found = pairs_[c]->found_number(record);
    const Real beyond = std::fabs(found - wanted) - pairs_[c]->resolution(static_cast<double>(wanted));
    if (std::isnan(beyond)) return formulas::kInfinity;
    sum2 += beyond > 0 ? beyond * beyond : 0;
  }
  return std::sqrt(sum2);
}

Real MadeValue::distance(const Estimate& e, const std::byte* record) const {
  Real least = distance_to(e.value, record);
  if (e.either_sign) least = std::min(least, distance_to(Real{-1} * e.value, record));
  if (e.may_be_undefined && distance_to({}, record) == 0) least = 0;
  return least;
}

std::optional<std::size_t> MadeValue::wrong_component(const Estimate& e, const std::byte* result,
                                                      const std::byte* record) const {
  if (e.is_open()) return std::nullopt;
  if (is_exact(e)) {
    for (std::size_t c = 0; c < pairs_.size(); ++c)
      if (pairs_[c] && !are_equal(*pairs_[c], result, record)) return c;
    return std::nullopt;
  }
  if (distance(e, record) <= e.error) return std::nullopt;
  std::size_t worst = 0;
  Real most = -formulas::kInfinity;
  for (std::size_t c = 0; c < pairs_.size(); ++c) {
    if (!pairs_[c]) continue;
    const double wanted = static_cast<double>(e.value[c]);
    const Real off = std::fabs(pairs_[c]->found_number(record) - e.value[c]) - pairs_[c]->resolution(wanted);
    if (!(off <= most)) most = off, worst = c;
  }
  return worst;
}

std::string MadeValue::difference(std::size_t c, const Estimate& e, const std::byte* result,
                                  const std::byte* record) const {
  std::string text = fmt::format("{} is {}, but {} by brute force", pairs_[c]->name(), pairs_[c]->found_value(record),
                                 pairs_[c]->expected_value(result));
  if (!is_exact(e)) text += fmt::format(", give or take {:.1e}", static_cast<double>(e.error));
  return text;
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
