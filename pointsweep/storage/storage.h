// SPDX-License-Identifier: MIT
/// Objects of bytes in any storage: readable at any offset, and visible only when they are complete (docs/adr/0018).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// Bytes that do not change while they are read. Thread-safe.
class Source {
 public:
  virtual ~Source() = default;
  virtual std::string name() const = 0;  ///< name for messages
  virtual std::uint64_t size() const = 0;
  /// Fills `bytes` from `offset` on. Throws Error if the source has fewer bytes.
  virtual void read_at(std::uint64_t offset, std::span<std::byte> bytes) const = 0;
};

/// An object that is being written. Without seal(), the destructor leaves nothing of the object, except what an
/// OutputFile has written to standard output.
class Unsealed {
 public:
  virtual ~Unsealed() = default;
  /// Writes after the bytes of earlier calls of append().
  virtual void append(std::span<const std::byte> bytes) = 0;
  /// Writes bytes from `offset` on. Thread-safe for bytes that do not overlap.
  virtual void write_at(std::uint64_t offset, std::span<const std::byte> bytes) = 0;
  /// Makes the complete object visible, in one step. Must be called once, after the last byte.
  virtual void seal() = 0;
};

/// A place that holds complete (sealed) objects, each under a key. Failures throw Error, except in remove().
class Storage {
 public:
  virtual ~Storage() = default;
  /// Opens a sealed object.
  virtual std::unique_ptr<Source> open(const std::string& key) const = 0;
  /// Begins a new object, which replaces the object with this key when the new object is sealed.
  virtual std::unique_ptr<Unsealed> create(const std::string& key) = 0;
  /// Returns the keys of all sealed objects, ascending.
  virtual std::vector<std::string> list() const = 0;
  /// Removes the object with this key, if it exists. A failure is ignored.
  virtual void remove(const std::string& key) = 0;
};

/// Returns a checksum: a variant of FNV-1a over little-endian words of eight bytes, with the last word filled up with
/// zeros. Four sums take the words in turn, as long as four words remain. The number of bytes, the four sums and the
/// remaining words are then joined into one sum.
std::uint64_t checksum_of(std::span<const std::byte> bytes);
/// Stores and seals an object that holds a signature, the number of `bytes`, their checksum, and the bytes.
void seal_bytes(Storage& storage, const std::string& key, std::span<const std::byte> bytes);
/// Returns the head of an object that seal_bytes() has stored: the signature, the number of bytes and their checksum.
/// Does not read the bytes. Objects with equal heads count as equal. Returns nothing if the object has no complete
/// head.
std::vector<std::byte> sealed_identity(const Storage& storage, const std::string& key);
/// Returns the bytes of an object that seal_bytes() has stored; nothing if the object is damaged.
std::optional<std::vector<std::byte>> sealed_bytes(const Storage& storage, const std::string& key);

/// Returns the value that decode(Decoder&) makes of the bytes that seal_bytes() has stored. Throws Error, which calls
/// the object damaged, if the object is incomplete, its checksum is wrong, or bytes follow the value.
template <class Decode>
auto sealed_value(const Storage& storage, const std::string& key, const Decode& decode) {
  const std::optional<std::vector<std::byte>> bytes = sealed_bytes(storage, key);
  if (!bytes) fail("{}: is damaged.", key);
  Decoder in(*bytes);
  auto value = decode(in);
  in.finish();
  return value;
}

/// Returns the value that T::decode() makes of the bytes that seal_bytes() has stored. Throws the errors of the
/// overload above.
template <class T>
T sealed_value(const Storage& storage, const std::string& key) {
  return sealed_value(storage, key, &T::decode);
}

}  // namespace pointsweep
