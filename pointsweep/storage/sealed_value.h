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

/// Returns the value whose bytes seal_bytes() has stored. Throws Error, which calls the object damaged, if the object
/// is incomplete or its checksum is wrong.
template <class T>
T sealed_value(const Storage& storage, const std::string& key) {
  const std::optional<std::vector<std::byte>> bytes = sealed_bytes(storage, key);
  if (!bytes) fail("{}: is damaged.", key);
  return decoded<T>(*bytes);
}

}  // namespace pointsweep
