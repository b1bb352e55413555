// SPDX-License-Identifier: MIT
#include "pointsweep/verify/kept_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "pointsweep/cancellation.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {
namespace {

/// Which of the present rows of `cloud` are kept.
using Mask = std::vector<bool>;

struct PlacedRow {
  Vec3 at;
  std::uint64_t row;
};

/// By which turn a place is looked at; equal places have the same, -0 and 0 too.
std::uint64_t turn_of(Vec3 p, std::uint64_t turns) {
  std::uint64_t hash = 0;
  for (const double v : {p.x, p.y, p.z}) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(v + 0.0)) * 0x9E3779B97F4A7C15;
    hash ^= hash >> 29;
  }
  return hash % turns;
}

Mask firsts_of_equal(InputCloud& cloud, std::uint64_t memory_bytes, const PhaseProgress& progress) {
  Mask kept(cloud.count(), true);
  const std::uint64_t turns = 1 + cloud.count() * 2 * sizeof(PlacedRow) / std::max<std::uint64_t>(memory_bytes, 1);
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    std::vector<PlacedRow> points;
    RowSource source(cloud);
    for_each_position(source, "reading", progress, [&](std::uint64_t row, Vec3 p) {
      if (is_finite(p) && turn_of(p, turns) == turn) points.push_back({p, row});
    });
    const auto key = [](const PlacedRow& p) { return std::tuple(p.at.x, p.at.y, p.at.z, p.row); };
    std::sort(points.begin(), points.end(), [&](const PlacedRow& a, const PlacedRow& b) { return key(a) < key(b); });
    for (std::size_t i = 1; i < points.size(); ++i)
      if (points[i].at == points[i - 1].at) kept[points[i].row] = false;
  }
  return kept;
}

/// A stored value as the operator reads it: in its own type, or as float64.
void put_value(const Field& field, const std::byte* record, Type type, std::byte* to) {
  if (field.is_plain() && field.type == type) return void(std::copy_n(record + field.offset, size_of(type), to));
  set_value({.name = "", .type = type}, to, value_of(field, record));
}

/// Asks the operator about one row at a time.
Mask by_condition(InputCloud& cloud, const Operator& op, const PhaseProgress& progress) {
  const Contract contract = op.contract();
  const PositionFields position = position_fields(cloud.schema(), "the input");
  std::vector<std::uint16_t> reads;
  std::vector<std::vector<std::byte>> values;
  std::vector<Field> fields;
  for (const Attribute& a : contract.reads) {
    reads.push_back(static_cast<std::uint16_t>(reads.size()));
    values.emplace_back(a.bytes());
    fields.push_back(cloud.schema().fields[cloud.schema().find(a.fields.front()).value()]);
  }
  std::vector<const std::byte*> columns;
  for (const auto& value : values) columns.push_back(value.data());
  Mask kept;
  RowSource source(cloud);
  for (std::uint64_t row = 0; row < source.count();) {
    stop_if_cancelled();
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(source.block_rows(), source.count() - row));
    const std::span<const std::byte> records = source.read(row, n);
    for (std::size_t i = 0; i < n; ++i, ++row) {
      const std::byte* record = records.data() + i * source.schema().stride;
      for (std::size_t f = 0; f < fields.size(); ++f)
        put_value(fields[f], record, contract.reads[f].type, values[f].data());
      const double x = value_of(position.x, record), y = value_of(position.y, record), z = value_of(position.z, record);
      const std::uint32_t no_list[2] = {0, 0};
      std::byte decision{0};
      std::byte* const made[] = {&decision};
      DegeneratePoints degenerate;
      Columns out(made, 1, degenerate);
      op.apply({{&x, &y, &z, &row, columns.data()}, 1, nullptr, no_list, nullptr, reads, {}}, out);
      kept.push_back(decision != std::byte{0});
    }
    if (progress) progress("reading", row, source.count());
  }
  return kept;
}

/// As a selection of all rows of the cloud, of which `cloud` may have selected some already.
RowSelection selection_of(const InputCloud& cloud, const Mask& kept) {
  const RowSelection* before = cloud.selection();
  const std::uint64_t rows = before == nullptr ? cloud.count() : before->rows();
  auto all = std::make_shared<Mask>(rows);
  for (std::uint64_t row = 0, i = 0; row < rows; ++row)
    if (before == nullptr || before->has(row)) (*all)[row] = kept[i++];
  return {rows, [all](std::uint64_t block, std::span<std::byte> bits) {
            std::ranges::fill(bits, std::byte{0});
            const std::uint64_t first = block * RowSelection::kBlockRows;
            for (std::uint64_t i = 0; i < RowSelection::kBlockRows && first + i < all->size(); ++i)
              if ((*all)[first + i]) bits[i / 8] |= std::byte{1} << i % 8;
          }};
}

}  // namespace

std::size_t select_kept_rows(InputCloud& cloud, const std::vector<std::shared_ptr<const Operator>>& operators,
                             std::uint64_t memory_bytes, const PhaseProgress& progress) {
  std::size_t done = 0;
  for (; done < operators.size(); ++done) {
    const Selects selects = operators[done]->contract().selects;
    if (selects == Selects::nothing) break;
    const Mask kept = selects == Selects::first_of_equal ? firsts_of_equal(cloud, memory_bytes, progress)
                                                         : by_condition(cloud, *operators[done], progress);
    cloud.select(selection_of(cloud, kept));
  }
  return done;
}

}  // namespace pointsweep
