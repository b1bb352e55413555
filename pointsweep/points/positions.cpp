// SPDX-License-Identifier: MIT
/// Decodes records into three arrays of coordinates.
#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <ranges>

#include "pointsweep/fail.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// Number of records that stay in the first-level cache while they are visited once for each coordinate.
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

/// Decodes values as raw * scale + bias, with a rounded multiplication and a rounded addition.
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

}  // namespace pointsweep
