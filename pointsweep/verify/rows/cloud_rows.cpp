// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/cloud_rows.h"

#include <fmt/format.h>

#include <algorithm>

namespace pointsweep {
namespace {

struct PlaceOfRow {
  Vec3 position;
  std::uint64_t row;
};

std::size_t components_of(std::span<const ColumnSource> columns) {
  std::size_t components = 0;
  for (const ColumnSource& c : columns) components += c.attribute.fields.size();
  return components;
}

double as_type(Type type, double value) {
  return type == Type::f32 ? static_cast<double>(static_cast<float>(value)) : value;
}

/// Stores the values of the columns that come from the input or were computed again for row `row` of the input.
void put_from_input(std::span<const ColumnSource> columns, std::uint64_t row, const std::byte* record, double* values) {
  for (const ColumnSource& c : columns) {
    const std::size_t components = c.attribute.fields.size();
    for (std::size_t f = 0; f < c.in_input.size(); ++f)
      values[f] = as_type(c.attribute.type, value_of(c.in_input[f], record));
    if (c.made_again) std::copy_n(c.made_again->data() + row * components, components, values);
    values += components;
  }
}

void put_from_output(std::span<const ColumnSource> columns, const std::byte* record, double* values) {
  for (const ColumnSource& c : columns) {
    const bool turned = c.turned_by && c.turned_by->found_value(record) != 0;
    for (std::size_t f = 0; f < c.in_output.size(); ++f) {
      const double value = as_type(c.attribute.type, c.in_output[f].found_value(record));
      values[f] = turned ? -value : value;
    }
    values += c.attribute.fields.size();
  }
}

bool read_output(std::span<const ColumnSource> columns) {
  return std::ranges::any_of(columns, [](const ColumnSource& c) { return !c.in_output.empty(); });
}

}  // namespace

std::string bytes_text(std::uint64_t bytes) {
  const auto mib = static_cast<double>(bytes) / (1 << 20);
  return mib < 1024 ? fmt::format("{:.0f}M", std::ceil(mib)) : fmt::format("{:.1f}G", std::ceil(mib / 102.4) / 10);
}

void require_memory(std::uint64_t bytes, const CloudRows& rows) {
  if (bytes > rows.memory_bytes()) throw NeedsMemory(fmt::format("needs --memory {}", bytes_text(bytes)));
}

void CloudRows::require(std::span<const ColumnSource> columns) const {
  if (axis_ >= 0 && read_output(columns))
    require_memory(count() * (sizeof(PlaceOfRow) + components_of(columns) * sizeof(double)), *this);
}

/// Returns values[row * components + c] for each row of the input, with c counted over all columns; 0 for columns that
/// are not in the output. Sorts all positions of the input to find the rows of the output.
std::vector<double> CloudRows::values_in_order_of_input(std::span<const ColumnSource> columns, std::size_t components) {
  require(columns);
  std::vector<PlaceOfRow> order;
  order.reserve(count());
  for_each_position(in_, "ordering", progress_, [&](std::uint64_t row, Vec3 p) { order.push_back({p, row}); });
  ++passes_;
  std::ranges::sort(order, {}, [&](const PlaceOfRow& p) { return sweep_key(p.position, p.row, axis_); });
  std::vector<double> values(count() * components);
  for_each_row(out_, "ordering", {}, [&](std::uint64_t place, const std::byte* record) {
    put_from_output(columns, record, values.data() + order[place].row * components);
  });
  return values;
}

void CloudRows::for_each(std::span<const ColumnSource> columns,
                         const std::function<void(std::uint64_t, Vec3, std::span<const double>)>& use) {
  const std::size_t components = components_of(columns);
  const bool reads_output = read_output(columns);
  std::vector<double> moved;
  if (reads_output && axis_ >= 0) moved = values_in_order_of_input(columns, components);
  const PositionFields position = position_fields(in_.schema(), in_.name());
  std::vector<double> values(components);
  std::span<const std::byte> out_records;
  std::uint64_t out_first = 0;
  ++passes_;
  for_each_row(in_, "reading", progress_, [&](std::uint64_t row, const std::byte* record) {
    if (!moved.empty()) {
      std::copy_n(moved.data() + row * components, components, values.data());
    } else if (reads_output) {
      const std::size_t stride = out_.schema().stride;
      if (row >= out_first + out_records.size() / stride) {
        out_first = row;
        out_records = out_.read_block(row);
      }
      put_from_output(columns, out_records.data() + (row - out_first) * stride, values.data());
    }
    put_from_input(columns, row, record, values.data());
    use(row, position_in(position, record), values);
  });
}

}  // namespace pointsweep
