// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/output_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pointsweep/order/source.h"
#include "pointsweep/points/input_row.h"
#include "pointsweep/row_error.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBlock = 256;  ///< number of records assembled at a time; usual ones fit in the L1 cache

void convert_values(const Field& from, const std::byte* records, std::size_t from_stride, const Field& to,
                    std::byte* outputs, std::size_t to_stride, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) set_value(to, outputs + i * to_stride, value_of(from, records + i * from_stride));
}

std::string range_text(const Field& field) {
  if (field.type == Type::f32) return "float32";
  if (field.bit_width != 0) return fmt::format("0 to {}", (std::uint64_t{1} << field.bit_width) - 1);
  return std::string(name_of(field.type));
}

/// Notes in `refused` the rows with a value that the field `to` cannot hold, or that an integer field without scale
/// would round.
void note_refused(const Field& from, const Field& to, const std::byte* records, std::size_t stride, std::size_t n,
                  RowNumbers rows, FirstRowError& refused) {
  for (std::size_t i = 0; i < n; ++i) {
    const double value = value_of(from, records + i * stride);
    const bool rounds = to.type != Type::f32 && to.scale == 1 && std::nearbyint(value) != value;
    if (holds(to, value) && !rounds) continue;
    refused.note(rows.of(i), [&] {
      return RowSentence{
          "Row ", fmt::format(": '{}' would be {}, which is not {}, what the field of the output holds; leave out such "
                              "points, or write the attribute under another name (--prefix).",
                              to.name, value, range_text(to))};
    });
  }
}

}  // namespace

bool moves_points(const std::vector<Attribute>& made) {
  return std::ranges::find(made, position_attribute().name, &Attribute::name) != made.end();
}

OutputLayout::OutputLayout(const Schema& input, const std::vector<Attribute>& made, const KeptFields& kept,
                           std::optional<Type> positions)
    : schema_(without_input_row(input)), input_stride_(input.stride) {
  passed_.add(0, 0, schema_.stride);
  const Types types = replaced(input, made, kept, positions);
  if (kept.input)
    keep_fields(input, *kept.input, types);
  else
    retype(types);
  convert_positions(input, types, made);
  const Schema own = schema_;
  for (const Attribute& attribute : made) {
    for (const std::string& name : attribute.fields) {
      const Field from{.name = name, .type = attribute.type, .offset = result_stride_};
      result_stride_ += static_cast<std::uint32_t>(size_of(attribute.type));
      if (kept.left_out.contains(name)) continue;
      const auto known = own.find(name);
      const std::size_t index = known ? *known : schema_.append(name, attribute.type);
      add(from, schema_.fields[index]);
    }
  }
}

/// Returns the fields of the input that get another type, from the made attribute that replaces them or from
/// `positions`. Bit fields, which share their bytes with others, and arrays keep their storage.
OutputLayout::Types OutputLayout::replaced(const Schema& input, const std::vector<Attribute>& made,
                                           const KeptFields& kept, std::optional<Type> positions) {
  Types types;
  const auto give = [&](const std::vector<std::string>& names, Type type) {
    for (const std::string& name : names) {
      const auto known = input.find(name);
      if (!known || kept.left_out.contains(name)) continue;
      const Field& field = input.fields[*known];
      const bool as_made = field.is_plain() && field.type == type;
      if (!as_made && field.bit_width == 0 && field.count == 1) types[*known] = type;
    }
  };
  for (const Attribute& attribute : made) give(attribute.fields, attribute.type);
  if (positions) {
    for (const std::string& axis : position_attribute().fields) types.erase(input.find(axis).value());
    give(position_attribute().fields, *positions);
  }
  return types;
}

/// Adds conversions for the coordinates of the input that get another type, except for coordinates that a stage makes.
void OutputLayout::convert_positions(const Schema& input, const Types& types, const std::vector<Attribute>& made) {
  for (const std::string& axis : position_attribute().fields) {
    const std::size_t own = input.find(axis).value();
    const bool is_made = std::ranges::any_of(
        made, [&](const Attribute& a) { return std::ranges::find(a.fields, axis) != a.fields.end(); });
    if (!is_made && types.contains(own))
      retyped_.emplace_back(input.fields[own], schema_.fields[schema_.find(axis).value()]);
  }
}

/// Changes fields to plain fields of the given types. The fields after them in the record move.
void OutputLayout::retype(const Types& types) {
  if (types.empty()) return;
  std::vector<std::pair<Field*, Type>> retyped;
  for (const auto& [index, type] : types) retyped.emplace_back(&schema_.fields[index], type);
  std::ranges::sort(retyped, {}, [](const auto& field) { return field.first->offset; });
  passed_ = {};
  struct Piece {
    std::uint32_t from, to, bytes;
  };
  std::vector<Piece> pieces;  // parts of the input's record between the retyped fields
  const std::uint32_t end = schema_.stride;
  std::uint32_t from = 0, to = 0;
  for (const auto& [field, type] : retyped) {
    pieces.push_back({from, to, field->offset - from});
    to += field->offset - from;
    from = field->offset + static_cast<std::uint32_t>(size_of(field->type));
    *field = {.name = field->name, .type = type, .offset = to};
    to += static_cast<std::uint32_t>(size_of(type));
  }
  pieces.push_back({from, to, end - from});
  schema_.stride = to + end - from;
  for (std::size_t f = 0; f < schema_.fields.size(); ++f) {
    if (types.contains(f)) continue;
    Field& field = schema_.fields[f];
    const auto piece =
        std::find_if(pieces.rbegin(), pieces.rend(), [&](const Piece& p) { return p.from <= field.offset; });
    field.offset = piece->to + (field.offset - piece->from);
  }
  for (const Piece& piece : pieces) passed_.add(piece.from, piece.to, piece.bytes);
}

/// Keeps the fields `kept`. Fields in `types` get these types, other fields keep their storage. Bit fields that share a
/// byte no longer share it: each gets its own copy of the byte.
void OutputLayout::keep_fields(const Schema& input, const std::vector<std::size_t>& kept, const Types& types) {
  schema_ = {};
  passed_ = {};
  for (const std::size_t index : kept) {
    Field field = input.fields[index];
    const auto type = types.find(index);
    if (type == types.end())
      passed_.append(std::move(field), schema_);
    else
      schema_.append(field.name, type->second);
  }
}

void OutputLayout::add(const Field& from, const Field& to) {
  if (!to.is_plain() || to.type != from.type) return conversions_.push_back({from, to});
  copies_.add(from.offset, to.offset, size_of(from.type));
}

void OutputLayout::require_held(const std::byte* inputs, const std::byte* results, std::size_t n,
                                RowNumbers rows) const {
  FirstRowError refused;
  const auto check = [&](const auto& conversions, const std::byte* records, std::size_t stride) {
    for (const auto& [from, to] : conversions)
      if (!holds_all_of(to, from)) note_refused(from, to, records, stride, n, rows, refused);
  };
  check(retyped_, inputs, input_stride_);
  check(conversions_, results, result_stride_);
  refused.throw_if_any();
}

bool OutputLayout::passes_inputs() const {
  return passed_.copies_whole(input_stride_) && input_stride_ == schema_.stride && copies_.empty() &&
         conversions_.empty() && retyped_.empty();
}

void OutputLayout::assemble(const std::byte* inputs, const std::byte* results, std::size_t n, std::byte* outputs,
                            RowNumbers rows) const {
  require_held(inputs, results, n, rows);
  for (std::size_t i = 0; i < n; i += kBlock) {
    assemble_block(inputs, results, std::min(kBlock, n - i), outputs);
    inputs += kBlock * input_stride_, results += kBlock * result_stride_, outputs += kBlock * schema_.stride;
  }
}

void OutputLayout::assemble_all(const std::byte* inputs, const std::byte* results, std::size_t n, std::byte* outputs,
                                std::uint64_t first) const {
  for_each_task(n, [&](std::size_t row, std::size_t m) {
    assemble(inputs + row * input_stride_, results == nullptr ? nullptr : results + row * result_stride_, m,
             outputs + row * schema_.stride, {first + row});
  });
}

void OutputLayout::assemble_block(const std::byte* inputs, const std::byte* results, std::size_t n,
                                  std::byte* outputs) const {
  passed_.copy(inputs, input_stride_, outputs, schema_.stride, n);
  copies_.copy(results, result_stride_, outputs, schema_.stride, n);
  for (const auto& [from, to] : retyped_) convert_values(from, inputs, input_stride_, to, outputs, schema_.stride, n);
  for (const auto& [from, to] : conversions_)
    convert_values(from, results, result_stride_, to, outputs, schema_.stride, n);
}

}  // namespace pointsweep
