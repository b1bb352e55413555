// SPDX-License-Identifier: MIT
/// Decodes the coordinates of records, and converts records of one schema into records of another.
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <ranges>

#include "pointsweep/fail.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// Number of records that stay in the L1 cache while the coordinates are decoded one after another.
constexpr std::size_t kBlock = 256;

template <class T>
double load(const std::byte* at) {
  T raw;
  std::memcpy(&raw, at, sizeof raw);
  return static_cast<double>(raw);
}

template <class T>
void decode_plain(const std::byte* at, std::size_t stride, std::size_t count, double* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = load<T>(at + i * stride);
}

/// Decodes values as raw * scale + bias. Multiplication and addition round separately, as in value_of(): a fused
/// multiply-add would give other bits.
template <class T>
void decode_scaled(const std::byte* at, std::size_t stride, std::size_t count, double scale, double bias, double* out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = load<T>(at + i * stride) * scale + bias;
}

void decode_axis(const Field& field, const std::byte* records, std::size_t stride, std::size_t count, double* out) {
  if (field.bit_width != 0) {
    for (std::size_t i = 0; i < count; ++i) out[i] = value_of(field, records + i * stride);
    return;
  }
  with_type(field.type, [&]<class T>() {
    const std::byte* at = records + field.offset;
    if (field.is_plain()) {
      decode_plain<T>(at, stride, count, out);
    } else {
      decode_scaled<T>(at, stride, count, field.scale, field.bias, out);
    }
  });
}

std::string names_of(const Schema& schema) {
  const auto names = schema.fields | std::views::transform(&Field::name);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// Returns the field of `from` with the name of `to.fields[index]`; null if `from` has no such field. If several fields
/// have this name, the n-th of them in `to` belongs to the n-th of them in `from`.
const Field* counterpart(const Schema& from, const Schema& to, std::size_t index) {
  const std::string& name = to.fields[index].name;
  const auto named = [&](const Field& field) { return field.name == name; };
  auto before = std::count_if(to.fields.begin(), to.fields.begin() + static_cast<std::ptrdiff_t>(index), named);
  for (const Field& field : from.fields) {
    if (named(field) && before-- == 0) return &field;
  }
  return nullptr;
}

/// Returns whether a value has the same bytes in both fields, which may hold arrays of different lengths.
bool same_storage(const Field& a, const Field& b) {
  return a.type == b.type && a.bit_width == 0 && b.bit_width == 0 && a.scale == b.scale && a.bias == b.bias;
}

std::uint32_t bytes_of(const Field& field) { return static_cast<std::uint32_t>(size_of(field.type)) * field.count; }

/// Returns a field of the first `count` bytes of `field`, so that the copies of adjacent fields can be joined.
Field as_bytes(const Field& field, std::uint32_t count) {
  Field bytes;
  bytes.type = Type::u8;
  bytes.offset = field.offset;
  bytes.count = count;
  return bytes;
}

}  // namespace

PositionFields position_fields(const Schema& schema, std::string_view where) {
  const auto field = [&](const char* axis) {
    const auto at = schema.find(axis);
    if (!at)
      fail("{}: its points have no {}; a point cloud needs the fields x, y and z (fields found: {}).", where, axis,
           names_of(schema));
    return schema.fields[*at];
  };
  return {field("x"), field("y"), field("z")};
}

void decode_positions(const PositionFields& fields, const std::byte* records, std::size_t stride, std::size_t count,
                      double* x, double* y, double* z) {
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t n = std::min(kBlock, count - first);
    const std::byte* block = records + first * stride;
    decode_axis(fields.x, block, stride, n, x + first);
    decode_axis(fields.y, block, stride, n, y + first);
    decode_axis(fields.z, block, stride, n, z + first);
  }
}

RecordConversion::RecordConversion(const Schema& from, const Schema& to)
    : from_stride_(from.stride), to_stride_(to.stride), identity_(from == to) {
  for (std::size_t i = 0; i < to.fields.size(); ++i) {
    const Field* source = counterpart(from, to, i);
    if (source == nullptr) continue;
    const Field& target = to.fields[i];
    if (!same_storage(*source, target)) {
      steps_.push_back({*source, target, false});
      continue;
    }
    const std::uint32_t bytes = std::min(bytes_of(*source), bytes_of(target));
    const Step step{as_bytes(*source, bytes), as_bytes(target, bytes), true};
    Step* last = steps_.empty() ? nullptr : &steps_.back();
    if (last && last->bitwise && last->from.offset + last->from.count == step.from.offset &&
        last->to.offset + last->to.count == step.to.offset) {
      last->from.count += step.from.count;
      last->to.count += step.to.count;
    } else {
      steps_.push_back(step);
    }
  }
}

void RecordConversion::run(const std::byte* from, std::byte* to, std::size_t count) const {
  if (identity_) {
    if (count != 0) std::memcpy(to, from, count * to_stride_);
    return;
  }
  for (std::size_t i = 0; i < count; ++i, from += from_stride_, to += to_stride_) {
    std::memset(to, 0, to_stride_);
    for (const Step& step : steps_) {
      if (step.bitwise) {
        std::memcpy(to + step.to.offset, from + step.from.offset, step.to.count);
        continue;
      }
      const std::uint32_t components = std::min(step.from.count, step.to.count);
      for (std::uint32_t c = 0; c < components; ++c) set_value(step.to, to, value_of(step.from, from, c), c);
    }
  }
}

}  // namespace pointsweep
