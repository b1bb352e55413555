// SPDX-License-Identifier: MIT
/// The numbers of neighbours that a point keeps of those found, by the rules.
#pragma once

#include <optional>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

struct Kept {
  std::size_t count = 0;
  bool certain = true;  ///< false if rounding decides between this and another count
};

/// The k from `least` to |neighbors| at which the eigenentropy E = -Σ e ln e is least, of equal ones the smallest; e
/// are the eigenvalues of the covariance of the positions of p and its k nearest neighbours about their mean, over
/// their sum (Weinmann et al. 2014). `neighbors` come nearest first. A k whose neighbours are all on p has no E. With
/// fewer than `least` neighbours, or no E at all, all are kept.
Kept of_least_eigenentropy(const Place& p, std::span<const Place> neighbors, std::size_t least);

/// The neighbours that both limits allow: the first floor(k), and those with ((dx² + dy²) + dz²) <= radius · radius in
/// float64.
/// A k below 1, a negative radius and NaN allow none.
Kept within_limits(const Place& p, std::span<const Place> neighbors, std::optional<double> k,
                   std::optional<double> radius);

}  // namespace pointsweep::formulas
