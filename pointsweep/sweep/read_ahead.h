// SPDX-License-Identifier: MIT
/// Slabs being read and cut while earlier ones are worked on.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>

#include "pointsweep/sweep/slab_loader.h"

namespace pointsweep {

class ReadAhead {
 public:
  /// Slabs [first, slabs).
  ReadAhead(const SlabLoader& loader, std::size_t first, std::size_t slabs, std::size_t depth, bool keep_records);
  ~ReadAhead();
  /// The next slab in order; starts the one `depth` further on. Throws what its loading threw.
  LoadedSlab next();
  double seconds() const { return seconds_; }  ///< spent loading what next() has returned

 private:
  struct Pending;
  void start();

  const SlabLoader& loader_;
  std::size_t started_, slabs_, depth_;
  bool keep_records_;
  std::deque<std::unique_ptr<Pending>> pending_;
  double seconds_ = 0;
};

}  // namespace pointsweep
