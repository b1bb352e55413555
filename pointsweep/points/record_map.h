// SPDX-License-Identifier: MIT
/// A copy of parts of records into records of another layout, bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "pointsweep/attribute.h"

namespace pointsweep {

class RecordMap {
 public:
  /// Adds a part to be copied: `bytes` bytes, from offset `from` of a source record to offset `to` of a target record.
  /// Parts that lie side by side in both records become one part.
  void add(std::size_t from, std::size_t to, std::size_t bytes);
  /// Appends `field` with its storage to the schema `to` of the target records, without a gap, and adds its bytes as a
  /// part.
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
