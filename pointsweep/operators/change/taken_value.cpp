// SPDX-License-Identifier: MIT
#include "pointsweep/operators/change/taken_value.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "pointsweep/operators/statistics/statistics_of_values.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// The factor between a colour channel of 8 bits and a channel of 16 bits with the same brightness: 65535 / 255.
constexpr int kWideOfNarrow = 257;

template <class Value>
VotedValue voted(Value value) {
  if constexpr (std::is_integral_v<Value>)
    return {.is_whole = true, .whole = value};
  else
    return {.real = value};
}

/// Combines values that are stored as T. Computes with Value: float64 or a whole number of 64 bits.
template <class T, class Value>
std::optional<VotedValue> vote_of(TakeVote vote, const std::byte* first, std::size_t count, std::size_t stride) {
  const auto value = [&](std::size_t i) {
    T stored;
    std::memcpy(&stored, first + i * stride, sizeof stored);
    return static_cast<Value>(stored);
  };
  if (count == 0) return std::nullopt;
  if (vote == TakeVote::nearest || (vote == TakeVote::majority && count == 1)) return voted(value(0));
  thread_local std::vector<Value> values, sorted;
  values.clear();
  for (std::size_t i = 0; i < count; ++i)
    if (std::is_integral_v<Value> || std::isfinite(static_cast<double>(value(i)))) values.push_back(value(i));
  const std::span<const Value> list = values;
  if (list.empty()) return std::nullopt;
  if (vote == TakeVote::mean) return VotedValue{.real = mean_of(list)};
  return voted(majority_of(list, sorted));
}

/// Converts a colour channel between 8 and 16 bits, so that its brightness is unchanged.
VotedValue with_brightness(VotedValue value, Type from, Type to) {
  if (from == Type::u8 && to == Type::u16) {
    value.whole *= kWideOfNarrow, value.real *= kWideOfNarrow;
  } else if (from == Type::u16 && to == Type::u8) {
    value = {.real = std::nearbyint(value.number() / kWideOfNarrow)};
  }
  return value;
}

template <class T>
std::optional<T> as_type(const VotedValue& value, const TargetRange& range, bool rounds) {
  if constexpr (std::is_integral_v<T>) {
    if (value.is_whole) return whole_in<T>(range, value.whole);
    const double whole = std::nearbyint(value.real);
    if (!rounds && whole != value.real) return std::nullopt;
    return whole_in<T>(range, whole);
  } else {
    const auto number = static_cast<T>(value.number());
    const bool fits = value.is_whole ? static_cast<WholeNumber>(number) == value.whole
                                     : std::isfinite(number) || !std::isfinite(value.real);
    return fits ? std::optional(number) : std::nullopt;
  }
}

}  // namespace

std::optional<VotedValue> voted_value(const TakenAttribute& taken, TakeVote vote, std::span<const std::byte> records,
                                      std::size_t record_bytes) {
  const std::size_t count = records.size() / record_bytes;
  std::optional<VotedValue> value = with_type(taken.source.type, [&]<class T>() {
    using Value = std::conditional_t<std::is_floating_point_v<T>, double,
                                     std::conditional_t<std::is_signed_v<T>, std::int64_t, std::uint64_t>>;
    return vote_of<T, Value>(vote, records.data() + taken.from, count, record_bytes);
  });
  if (value && taken.is_color) value = with_brightness(*value, taken.source.type, taken.range.type);
  return value;
}

bool put_value(const VotedValue& value, const TakenAttribute& taken, bool rounds, std::byte* record) {
  return with_type(taken.range.type, [&]<class T>() {
    const std::optional<T> stored = as_type<T>(value, taken.range, rounds);
    if (stored) std::memcpy(record + taken.to, &*stored, sizeof *stored);
    return stored.has_value();
  });
}

}  // namespace pointsweep
