// SPDX-License-Identifier: MIT
/// Encoded values as objects of a storage.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Returns the value that decode(in) makes of the bytes that seal_bytes() has stored. Throws Error, which calls the
/// object damaged, if the object is incomplete or its checksum is wrong; also if bytes follow the value.
template <class Decode>
auto sealed_value(const Storage& storage, const std::string& key, const Decode& decode) {
  const std::optional<std::vector<std::byte>> bytes = sealed_bytes(storage, key);
  if (!bytes) fail("{}: is damaged.", key);
  Decoder in(*bytes);
  auto value = decode(in);
  in.finish();
  return value;
}

/// Returns the value that T::decode() makes of the bytes that seal_bytes() has stored. Throws the same errors.
template <class T>
T sealed_value(const Storage& storage, const std::string& key) {
  return sealed_value(storage, key, &T::decode);
}

}  // namespace pointsweep
