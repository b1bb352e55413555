// SPDX-License-Identifier: MIT
#include "pointsweep/points/record_map.h"

#include <utility>

namespace pointsweep {

void RecordMap::add(std::size_t from, std::size_t to, std::size_t bytes) {
  if (bytes == 0) return;
  if (!parts_.empty()) {
    Part& last = parts_.back();
    if (last.from + last.bytes == from && last.to + last.bytes == to) return void(last.bytes += bytes);
  }
  parts_.push_back({from, to, bytes});
}

void RecordMap::append(Field field, Schema& to) {
  const auto bytes = static_cast<std::uint32_t>(size_of(field.type) * field.count);
  add(field.offset, to.stride, bytes);
  field.offset = to.stride;
  to.stride += bytes;
  to.fields.push_back(std::move(field));
}

void RecordMap::copy(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride,
                     std::size_t n) const {
  for (const Part& part : parts_)
    with_fixed_size(part.bytes, [&](auto size) {
      for (std::size_t i = 0; i < n; ++i)
        copy_bytes<size()>(to + i * to_stride + part.to, from + i * from_stride + part.from, part.bytes);
    });
}

void RecordMap::scatter(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride,
                        const std::uint32_t* place, std::size_t n) const {
  for (const Part& part : parts_)
    with_fixed_size(part.bytes, [&](auto size) {
      for (std::size_t i = 0; i < n; ++i)
        copy_bytes<size()>(to + place[i] * to_stride + part.to, from + i * from_stride + part.from, part.bytes);
    });
}

bool RecordMap::copies_whole(std::size_t bytes) const {
  return parts_.size() == 1 && parts_[0].from == 0 && parts_[0].to == 0 && parts_[0].bytes == bytes;
}

}  // namespace pointsweep
