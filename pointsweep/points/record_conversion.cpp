// SPDX-License-Identifier: MIT
/// Converts records of one schema into records of another.
#include <algorithm>
#include <cstring>

#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

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

/// Returns whether both fields store values in the same way, though perhaps arrays of different lengths.
bool same_storage(const Field& a, const Field& b) {
  return a.type == b.type && a.bit_width == 0 && b.bit_width == 0 && a.scale == b.scale && a.bias == b.bias;
}

std::uint32_t bytes_of(const Field& field) { return static_cast<std::uint32_t>(size_of(field.type)) * field.count; }

/// Returns the first `count` bytes of the field as an array, so that adjacent fields can be copied at once.
Field as_bytes(const Field& field, std::uint32_t count) {
  Field bytes;
  bytes.type = Type::u8;
  bytes.offset = field.offset;
  bytes.count = count;
  return bytes;
}

}  // namespace

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
