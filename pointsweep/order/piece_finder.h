// SPDX-License-Identifier: MIT
/// Finds the piece of the stream that a point belongs to.
#pragma once

#include <cstddef>
#include <span>

#include "pointsweep/order/local_spacing.h"
#include "pointsweep/order/splitters.h"

namespace pointsweep {

/// Finds the piece of a point. A second Splitters may exist for points in sparse places; its pieces are numbered after
/// those of the first.
class PieceFinder {
 public:
  /// Borrows `splitters` and `spacing`. `spacing` knows the sparse places; it may be null if there is one Splitters.
  PieceFinder(std::span<const Splitters> splitters, const LocalSpacing* spacing)
      : splitters_(splitters), spacing_(spacing) {}

  std::size_t pieces() const { return first_sparse_piece() + (splitters_.size() > 1 ? splitters_[1].pieces() : 0); }
  std::size_t first_sparse_piece() const { return splitters_[0].pieces(); }

  /// Returns the piece of a point. `p` must be finite; `key` is the value that the splitters divide.
  std::size_t piece_of(Vec3 p, double key) const {
    if (splitters_.size() > 1 && spacing_->is_sparse(p)) return first_sparse_piece() + splitters_[1].piece_of(key);
    return splitters_[0].piece_of(key);
  }

 private:
  std::span<const Splitters> splitters_;
  const LocalSpacing* spacing_;
};

}  // namespace pointsweep
