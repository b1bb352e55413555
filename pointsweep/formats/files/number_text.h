// SPDX-License-Identifier: MIT
/// Numbers as people and programs write them, independent of any locale.
#pragma once

#include <string_view>

namespace pointsweep {

/// Reads all of `word` as a T (any type of a Field). Returns false if the word is no number or does not fit.
/// A leading '+', "nan" and "inf" in any case and the spellings of Windows ("-1.#IND") are read; a number beyond the
/// range of a floating type becomes infinite or zero. Integers may be written as "12.0" or "1e3".
template <class T>
bool parse_number(std::string_view word, T& value);

}  // namespace pointsweep
