// SPDX-License-Identifier: MIT
/// Threads for requests to servers. There are more of them than cores, since each waits most of the time.
#pragma once

#include <cstddef>
#include <functional>

namespace pointsweep {

/// Calls body(i) for each i < count, up to 16 of them at once. If bodies throw, rethrows the exception of the lowest i.
void for_each_waiting(std::size_t count, const std::function<void(std::size_t i)>& body);

}  // namespace pointsweep
