// SPDX-License-Identifier: MIT
/// Values one after another as bytes, for the checkpoints of a run: read by the build that wrote them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pointsweep/fail.h"

namespace pointsweep {

template <class T>
concept Packable = std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>;

class Packer {
 public:
  template <Packable T>
  void put(const T& value) {
    append(&value, sizeof value);
  }
  template <Packable T>
  void put(const std::vector<T>& values) {
    put<std::uint64_t>(values.size());
    append(values.data(), values.size() * sizeof(T));
  }
  void put_text(std::string_view text) {
    put<std::uint64_t>(text.size());
    append(text.data(), text.size());
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  void append(const void* from, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  std::vector<std::byte> bytes_;
};

/// Gives the values back in the order they were put. Throws Error where the bytes end before.
class Unpacker {
 public:
  /// The bytes must outlive it.
  explicit Unpacker(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <Packable T>
  T get() {
    T value;
    take(&value, sizeof value, 1);
    return value;
  }
  template <Packable T>
  std::vector<T> get_vector() {
    const auto size = get<std::uint64_t>();
    require(size, sizeof(T));
    std::vector<T> values(size);
    take(values.data(), sizeof(T), size);
    return values;
  }
  std::string get_text() {
    const auto size = get<std::uint64_t>();
    require(size, 1);
    std::string text(size, '\0');
    take(text.data(), 1, size);
    return text;
  }
  bool at_end() const { return rest_.empty(); }

 private:
  void require(std::uint64_t count, std::size_t size) const {
    if (count > rest_.size() / size) fail("a checkpoint ends too early: remove its folder and start again.");
  }
  void take(void* to, std::size_t size, std::uint64_t count) {
    require(count, size);
    if (count > 0) std::memcpy(to, rest_.data(), size * count);
    rest_ = rest_.subspan(size * count);
  }
  std::span<const std::byte> rest_;
};

}  // namespace pointsweep
