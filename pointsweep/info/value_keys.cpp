// SPDX-License-Identifier: MIT
#include "pointsweep/info/value_keys.h"

namespace pointsweep {

ValueKeys::ValueKeys(const Field& field) : field_(field), decimals_(field) {
  if (has_whole_numbers(field)) kind_ = field.type == Type::u64 && field.bit_width == 0 ? Kind::natural : Kind::whole;
}

void ValueKeys::find(std::span<const std::byte> records, std::size_t stride, std::vector<std::uint64_t>& keys) const {
  const std::size_t count = records.size() / stride;
  keys.resize(count * field_.count);
  const auto for_each = [&](const auto& key_at) {
    for (std::size_t i = 0, at = 0; i < count; ++i)
      for (std::uint32_t c = 0; c < field_.count; ++c, ++at) keys[at] = key_at(records.data() + i * stride, c);
  };
  const auto whole = [&](const std::byte* record, std::uint32_t c) {
    return static_cast<std::uint64_t>(whole_number_of(field_, record, c));
  };
  if (kind_ == Kind::natural) return for_each(whole);
  if (kind_ == Kind::whole)
    return for_each([&](const std::byte* record, std::uint32_t c) { return whole(record, c) ^ kSign; });
  if (!decimals_.any())
    return for_each([&](const std::byte* record, std::uint32_t c) { return key_of(value_of(field_, record, c)); });
  for_each([&](const std::byte* record, std::uint32_t c) { return key_of(decimals_.of(value_of(field_, record, c))); });
}

double ValueKeys::real(std::uint64_t key) const {
  if (is_whole()) return static_cast<double>(whole(key));
  return std::bit_cast<double>((key & kSign) != 0 ? key ^ kSign : ~key);
}

Int128 ValueKeys::whole(std::uint64_t key) const {
  if (kind_ == Kind::natural) return Int128{key};
  return Int128{static_cast<std::int64_t>(key ^ kSign)};
}

AttributeValue ValueKeys::value(std::uint64_t key) const {
  if (kind_ == Kind::natural) return key;
  if (kind_ == Kind::whole) return static_cast<std::int64_t>(key ^ kSign);
  return real(key);
}

}  // namespace pointsweep
