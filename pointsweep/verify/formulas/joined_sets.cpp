// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/joined_sets.h"

#include "pointsweep/verify/formulas/eigen.h"

namespace pointsweep::formulas {

void Flatness::measure(Vector p) {
  if (points_ == 0) first_ = p;
  points_ += 1;
  sum_ = sum_ + (p - first_);
}

void Flatness::add(Vector p) { covariance_.add_outer_product(1, p - first_ - (1 / points_) * sum_); }

/// The operator rounds each point to a place at most `displaced` away, which changes the root of the mean square by at
/// most as much.
Estimate Flatness::residual() const {
  if (points_ < 4) return {};
  const Real displaced = std::sqrt(Real{3}) * 0x1p-41L;
  const Real least = std::fmax(0, eigen_of(covariance_).value[0]) / points_, all = covariance_.trace() / points_;
  const Real error = 64 * kDouble * (all + displaced * displaced);
  const Range square = not_negative(around(least, error));
  return single_scalar(std::sqrt(least),
                       not_negative({std::sqrt(square.low) - displaced, std::sqrt(square.high) + displaced}));
}

void TurningVotes::measure(Vector p) {
  points_ += 1;
  sum_ = sum_ + p;
  low_ = {std::fmin(low_.x, p.x), std::fmin(low_.y, p.y), std::fmin(low_.z, p.z)};
  high_ = {std::fmax(high_.x, p.x), std::fmax(high_.y, p.y), std::fmax(high_.z, p.z)};
}

void TurningVotes::vote(Vector p, Vector n, const std::optional<Vector>& viewpoint) {
  if (viewpoint) {
    const Vector way = *viewpoint - p;
    const Real along = dot(n, way);
    if (std::fabs(along) <= 8 * kDouble * norm(n) * norm(way) && along != 0) in_doubt_ += 1;
    facing_ += along > 0 ? 1 : along < 0 ? -1 : 0;
    return;
  }
  if (!is_finite(n)) return;
  const Vector offset = p - (1 / points_) * sum_;
  up_ += n.z;
  out_ += dot(n, offset);
  offsets_ += std::fabs(offset.x) + std::fabs(offset.y) + std::fabs(offset.z);
}

std::optional<bool> TurningVotes::turns(bool has_viewpoint) const {
  if (has_viewpoint) return std::fabs(facing_) > 2 * in_doubt_ ? std::optional(facing_ < 0) : std::nullopt;
  const Vector size = high_ - low_;
  const Real extent = (size.x + size.y + size.z) / 3;
  const Real out = extent > 0 ? out_ / extent : 0;
  const Real largest = std::fmax(largest_component(low_), largest_component(high_));
  const Real rounding = points_ * 0x1p-20L;
  const Real places = points_ * (0x1p-30L + 0x1p-55L * points_ * largest);
  const Real out_error = extent > 0 ? (offsets_ * 0x1p-20L + places) / extent : 0;
  const bool up_decides = std::fabs(up_) - rounding > std::fabs(out) + out_error;
  const bool out_decides = std::fabs(out) - out_error > std::fabs(up_) + rounding;
  if (up_decides || (!out_decides && up_ > rounding && out > out_error)) return up_ < 0;
  if (out_decides) return out < 0;
  return up_ < -rounding && out < -out_error ? std::optional(true) : std::nullopt;
}

}  // namespace pointsweep::formulas
