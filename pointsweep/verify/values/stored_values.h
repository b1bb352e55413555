// SPDX-License-Identifier: MIT
/// Values of attributes in memory as numbers, and estimates as values. Whole numbers of 64 bits stay exact if their
/// field is plain and has the type that is read.
#pragma once

#include <cstddef>

#include "pointsweep/points/schema.h"
#include "pointsweep/verify/formulas/estimate.h"
#include "pointsweep/verify/formulas/plain_expression.h"

namespace pointsweep {

/// Converts the value of `field` in `record` to `type`, the type that stages read, and stores it at `to`.
void put_value(const Field& field, const std::byte* record, Type type, std::byte* to);

/// Returns component number `component` of the value.
formulas::Real number_in(Type type, const std::byte* value, std::size_t component = 0);

/// Stores the value of an attribute at `to`, each component converted once to its type. Up to three components come
/// from one estimate; more components come from one estimate each.
void put_estimates(const Attribute& a, const formulas::Estimate* estimates, std::byte* to);

/// Returns how an attribute of this type stores a number.
formulas::Storage storage_of(Type type);

}  // namespace pointsweep
