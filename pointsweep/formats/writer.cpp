// SPDX-License-Identifier: MIT
#include "pointsweep/writer.h"

#include <stdexcept>

namespace pointsweep {

void Writer::write_at(std::uint64_t, std::span<const std::byte>) {
  throw std::logic_error("write_at() was called on a writer whose can_write_at() is false");
}

}  // namespace pointsweep
