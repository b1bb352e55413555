// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output_layout.h"

#include <algorithm>
#include <iterator>

#include "pointsweep/order/fixed_copy.h"

namespace pointsweep {
namespace {

constexpr std::size_t kBlock = 256;  ///< records put together while they are in the nearest cache

void copy_pieces(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride,
                 std::size_t bytes, std::size_t n) {
  with_fixed_size(bytes, [&](auto size) {
    for (std::size_t i = 0; i < n; ++i) copy_bytes<size()>(to + i * to_stride, from + i * from_stride, bytes);
  });
}

}  // namespace

OutputLayout::OutputLayout(const Schema& input, const std::vector<Attribute>& made, const KeptFields& kept,
                           std::optional<Type> moved_positions)
    : schema_(input), input_stride_(input.stride), passed_{{0, 0, input.stride}} {
  const auto moves = [](const Attribute& a) { return a.name == position_attribute().name; };
  if (std::none_of(made.begin(), made.end(), moves)) moved_positions.reset();
  if (kept.input)
    keep_fields(input, *kept.input, moved_positions);
  else if (moved_positions)
    retype_positions(*moved_positions);
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

/// x, y and z become plain fields of that type; what stands behind them in the record moves up or down.
void OutputLayout::retype_positions(Type type) {
  std::vector<Field*> positions;
  for (const char* name : {"x", "y", "z"}) positions.push_back(&schema_.fields[*schema_.find(name)]);
  std::sort(positions.begin(), positions.end(), [](const Field* a, const Field* b) { return a->offset < b->offset; });
  passed_.clear();
  std::vector<Copy> pieces;  // of the input's record, between the positions
  std::uint32_t from = 0, to = 0;
  for (Field* field : positions) {
    pieces.push_back({from, to, field->offset - from});
    to += field->offset - from;
    from = field->offset + static_cast<std::uint32_t>(size_of(field->type));
    *field = {.name = field->name, .type = type, .offset = to};
    to += static_cast<std::uint32_t>(size_of(type));
  }
  pieces.push_back({from, to, input_stride_ - from});
  schema_.stride = to + input_stride_ - from;
  for (Field& field : schema_.fields) {
    if (std::find(positions.begin(), positions.end(), &field) != positions.end()) continue;
    const auto piece =
        std::find_if(pieces.rbegin(), pieces.rend(), [&](const Copy& c) { return c.from <= field.offset; });
    field.offset = piece->to + (field.offset - piece->from);
  }
  std::copy_if(pieces.begin(), pieces.end(), std::back_inserter(passed_), [](const Copy& c) { return c.bytes > 0; });
}

/// Fields keep their storage, except moved positions: bit fields that share a byte each get a copy of it.
void OutputLayout::keep_fields(const Schema& input, const std::vector<std::size_t>& kept,
                               std::optional<Type> moved_positions) {
  schema_ = {};
  passed_.clear();
  for (const std::size_t index : kept) {
    Field field = input.fields[index];
    const bool moved =
        moved_positions && (input.find("x") == index || input.find("y") == index || input.find("z") == index);
    if (moved) field = {.name = field.name, .type = *moved_positions};
    const auto bytes = static_cast<std::uint32_t>(size_of(field.type)) * field.count;
    if (!moved) append(passed_, {field.offset, schema_.stride, bytes});
    field.offset = schema_.stride;
    schema_.stride += bytes;
    schema_.fields.push_back(std::move(field));
  }
}

void OutputLayout::append(std::vector<Copy>& copies, const Copy& next) {
  if (!copies.empty()) {
    Copy& last = copies.back();
    if (last.from + last.bytes == next.from && last.to + last.bytes == next.to) return void(last.bytes += next.bytes);
  }
  copies.push_back(next);
}

void OutputLayout::add(const Field& from, const Field& to) {
  if (!to.is_plain() || to.type != from.type) return conversions_.push_back({from, to});
  append(copies_, {from.offset, to.offset, static_cast<std::uint32_t>(size_of(from.type))});
}

void OutputLayout::assemble(const std::byte* inputs, const std::byte* results, std::size_t n,
                            std::byte* outputs) const {
  for (std::size_t i = 0; i < n; i += kBlock) {
    assemble_block(inputs, results, std::min(kBlock, n - i), outputs);
    inputs += kBlock * input_stride_, results += kBlock * result_stride_, outputs += kBlock * schema_.stride;
  }
}

void OutputLayout::assemble_block(const std::byte* inputs, const std::byte* results, std::size_t n,
                                  std::byte* outputs) const {
  for (const Copy& c : passed_) copy_pieces(inputs + c.from, input_stride_, outputs + c.to, schema_.stride, c.bytes, n);
  for (const Copy& c : copies_)
    copy_pieces(results + c.from, result_stride_, outputs + c.to, schema_.stride, c.bytes, n);
  for (const auto& [from, to] : conversions_)
    for (std::size_t i = 0; i < n; ++i)
      set_value(to, outputs + i * schema_.stride, value_of(from, results + i * result_stride_));
}

}  // namespace pointsweep
