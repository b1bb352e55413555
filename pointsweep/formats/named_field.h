// SPDX-License-Identifier: MIT
/// An attribute that an option names.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns the field that a user means by `word` (field_meant). If there is none, throws UsageError, which begins with
/// the option and lists the fields.
const Field& named_field(const Schema& schema, const std::string& word, std::string_view option);

/// Returns the indices of the fields that a user means by `words`. Throws as named_field().
std::vector<std::size_t> named_fields(const Schema& schema, const std::vector<std::string>& words,
                                      std::string_view option);

}  // namespace pointsweep
