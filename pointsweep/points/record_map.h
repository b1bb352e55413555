// SPDX-License-Identifier: MIT
/// Copies parts of records bit for bit into records of another layout. The loops over records are compiled once for
/// each usual size of a part, because a copy of constant size needs no call of memcpy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>
#include <vector>

#include "pointsweep/attribute.h"

namespace pointsweep {

/// Copies `Bytes` bytes, or `bytes` bytes if `Bytes` is 0.
template <std::size_t Bytes>
inline void copy_bytes(std::byte* to, const std::byte* from, std::size_t bytes) {
  if constexpr (Bytes != 0)
    std::memcpy(to, from, Bytes);
  else
    std::memcpy(to, from, bytes);
}

/// Calls `loop(std::integral_constant<std::size_t, N>)` with N = bytes for the usual sizes, which are 1, 2 and the
/// multiples of 4 up to 96, and N = 0 for any other.
template <class Loop>
void with_fixed_size(std::size_t bytes, Loop&& loop) {
  const auto called = [&]<std::size_t Bytes>(std::integral_constant<std::size_t, Bytes> size) {
    if (bytes == Bytes) loop(size);
    return bytes == Bytes;
  };
  const bool found = [&]<std::size_t... I>(std::index_sequence<I...>) {
    return (called(std::integral_constant<std::size_t, 4 * (I + 1)>()) || ...);
  }
  (std::make_index_sequence<24>());
  if (found || called(std::integral_constant<std::size_t, 1>()) || called(std::integral_constant<std::size_t, 2>()))
    return;
  loop(std::integral_constant<std::size_t, 0>());
}

/// A list of parts of a source record, each with its place in a target record.
class RecordMap {
 public:
  /// Adds a part to be copied: `bytes` bytes, from offset `from` of a source record to offset `to` of a target record.
  /// A part that directly follows the part added before, in both records, is joined to that part.
  void add(std::size_t from, std::size_t to, std::size_t bytes);
  /// Appends `field`, with its type, scale, bias and bits, to the end of the schema `to` of the target records, and
  /// adds the bytes of `field` as a part.
  void append(Field field, Schema& to);

  /// Copies the parts of one record.
  void copy(const std::byte* from, std::byte* to) const {
    for (const Part& part : parts_) std::memcpy(to + part.to, from + part.from, part.bytes);
  }
  /// Copies the parts of `n` records, which are `from_stride` bytes apart, into records that are `to_stride` bytes
  /// apart.
  void copy(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride, std::size_t n) const;
  /// Copies the parts of `n` records; source record i becomes target record place[i].
  void scatter(const std::byte* from, std::size_t from_stride, std::byte* to, std::size_t to_stride,
               const std::uint32_t* place, std::size_t n) const;

  bool empty() const { return parts_.empty(); }
  /// Returns whether the map copies exactly the first `bytes` bytes of a record, to the start of the target record.
  bool copies_whole(std::size_t bytes) const;

 private:
  struct Part {
    std::size_t from, to, bytes;
  };
  std::vector<Part> parts_;
};

}  // namespace pointsweep
