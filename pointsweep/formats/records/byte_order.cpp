// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/byte_order.h"

#include <algorithm>

namespace pointsweep {

void reverse_values(std::span<const Field> fields, std::size_t stride, std::span<std::byte> records) {
  if (fields.empty()) return;
  for (std::byte *record = records.data(), *end = record + records.size(); record != end; record += stride) {
    for (const Field& field : fields) {
      const std::size_t size = size_of(field.type);
      if (size == 1) continue;
      std::byte* value = record + field.offset;
      for (std::uint32_t i = 0; i < field.count; ++i, value += size) std::reverse(value, value + size);
    }
  }
}

}  // namespace pointsweep
