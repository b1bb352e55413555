// SPDX-License-Identifier: MIT
/// Unfinished files that a process must remove even if it ends without unwinding its stack.
#pragma once

#include <cstddef>
#include <filesystem>

namespace pointsweep {

/// Lists a file or an empty folder for remove_leftovers() (process.h) during its lifetime; removes nothing itself. A
/// file must be listed before it is made, since the process may be stopped in between. At most 64 paths are listed at
/// once; further paths, and paths of 4,096 characters or more, are ignored.
class Leftover {
 public:
  Leftover() = default;
  explicit Leftover(const std::filesystem::path& path);
  ~Leftover() { forget(); }
  Leftover(const Leftover&) = delete;
  Leftover& operator=(const Leftover&) = delete;
  /// Takes the path off the list, because the file was removed or has become a complete output.
  void forget() noexcept;

 private:
  std::size_t place_ = kNone;
  static constexpr std::size_t kNone = ~std::size_t{0};
};

}  // namespace pointsweep
