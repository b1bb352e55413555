// SPDX-License-Identifier: MIT
#include "pointsweep/operators/declare/complete_lists.h"

#include "pointsweep/fail.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {

void require_complete_lists(const Facts& facts, std::size_t k, double radius, const std::string& where) {
  if (!facts.neighborhood) return;
  const Neighborhood& has = *facts.neighborhood;
  const std::string remedy = k == Neighborhood::kUnlimited
                                 ? fmt::format("write knn(radius={}) before it", radius)
                                 : fmt::format("write knn(k={}) or knn(radius={}) before it", k, radius);
  if (has.rule)
    fail_usage("{}: counts the neighbours within {}, but each point keeps {}; {}.", where, radius, has.rule->meaning(),
               remedy);
  if (!(has.radius >= radius))
    fail_usage("{}: counts the neighbours within {}, but those within {} are known; {}.", where, radius, has.radius,
               remedy);
  if (has.k == Neighborhood::kOfOperators) return;
  if (has.k < k) fail_usage("{}: needs more neighbours than the {} nearest; {}.", where, has.k, remedy);
}

}  // namespace pointsweep
