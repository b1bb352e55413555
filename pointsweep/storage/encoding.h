// SPDX-License-Identifier: MIT
/// Values as bytes that another process, another build or another machine can read (docs/adr/0017).
///
/// An encoded value begins with its kind and the version of its fields. The fields follow one by one, without gaps: a
/// number as its bytes in little-endian order, a truth value as one byte, a text or a list after the number of its
/// elements as 64 bits. A field may be an encoded value itself.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// The kind of an encoded value, and the version of its fields, which increases with every change of the fields.
struct Encoding {
  std::string_view kind;  ///< a constant of at most 255 bytes
  std::uint16_t version;
};

/// A number of fixed width.
template <class T>
concept Encodable = (std::integral<T> || std::floating_point<T>)&&!std::same_as<T, bool> && sizeof(T) <= 8;

template <Encodable T>
using EncodedBits =
    std::conditional_t<sizeof(T) == 1, std::uint8_t,
                       std::conditional_t<sizeof(T) == 2, std::uint16_t,
                                          std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;

/// Appends fields to bytes. The caller names the type of every number, because the type decides its width.
class Encoder {
 public:
  /// Appends the kind and the version of the value whose fields follow.
  void begin(Encoding encoding);

  template <Encodable T>
  void put(std::type_identity_t<T> value) {
    const auto bits = std::bit_cast<EncodedBits<T>>(value);
    std::array<std::byte, sizeof(T)> bytes;
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<std::byte>(bits >> 8 * i);
    append(bytes);
  }
  template <Encodable T>
  void put_numbers(std::span<const T> values) {
    put_list(values, [this](T value) { put<T>(value); });
  }
  void put_bool(bool value) { put<std::uint8_t>(value ? 1 : 0); }
  void put_text(std::string_view text);
  void put_bytes(std::span<const std::byte> bytes);
  void put_point(Vec3 p) {
    for (const double c : {p.x, p.y, p.z}) put<double>(c);
  }
  void put_box(const Box& box) {
    put_point(box.lo);
    put_point(box.hi);
  }
  /// Appends the number of elements, then calls put_element(element) for each of them.
  template <class List, class PutElement>
  void put_list(const List& elements, PutElement put_element) {
    put<std::uint64_t>(elements.size());
    for (const auto& element : elements) put_element(element);
  }

  const std::vector<std::byte>& bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void append(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  std::vector<std::byte> bytes_;
};

/// Returns fields in the order in which an Encoder has appended them. Throws Error if the bytes hold a value of another
/// kind or version, or end too early.
class Decoder {
 public:
  /// Reads the values in `bytes`, which the decoder borrows.
  explicit Decoder(std::span<const std::byte> bytes) : rest_(bytes) {}

  /// Reads the kind and version with which a value begins. Throws Error unless they are `expected`.
  void begin(Encoding expected);

  template <Encodable T>
  T get() {
    const std::span<const std::byte> bytes = take(sizeof(T));
    EncodedBits<T> bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bits = static_cast<EncodedBits<T>>(bits | static_cast<EncodedBits<T>>(bytes[i]) << 8 * i);
    return std::bit_cast<T>(bits);
  }
  template <Encodable T>
  std::vector<T> get_numbers() {
    return get_list<T>([this] { return get<T>(); });
  }
  bool get_bool();
  std::string get_text();
  std::vector<std::byte> get_bytes();
  /// Fills `to` with a list of bytes. Throws Error if the list has another size.
  void get_bytes(std::span<std::byte> to);
  Vec3 get_point() { return {get<double>(), get<double>(), get<double>()}; }  // braces evaluate from left to right
  Box get_box() { return {get_point(), get_point()}; }
  /// Returns a list. get_element() reads and returns one element, which takes at least one byte.
  template <class T, class GetElement>
  std::vector<T> get_list(GetElement get_element) {
    std::vector<T> elements;
    const std::uint64_t count = get_count();
    elements.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) elements.push_back(get_element());
    return elements;
  }

  /// Reads and returns the number of elements of a list. The caller then reads the elements one by one; an element
  /// takes at least one byte.
  std::uint64_t get_count();

  /// Throws Error if bytes follow the last field.
  void finish() const;

 private:
  std::span<const std::byte> take(std::uint64_t size);
  [[noreturn]] void refuse(const std::string& why) const;

  std::span<const std::byte> rest_;
  std::optional<Encoding> outermost_;
};

/// Returns the bytes of a value, made by its member encode(Encoder&). T may be const.
template <class T>
std::vector<std::byte> encoded(T& value) {
  Encoder out;
  value.encode(out);
  return out.take();
}

/// Returns the value that `bytes` hold. Throws Error if bytes follow the value.
template <class T>
T decoded(std::span<const std::byte> bytes) {
  Decoder in(bytes);
  T value = T::decode(in);
  in.finish();
  return value;
}

}  // namespace pointsweep
