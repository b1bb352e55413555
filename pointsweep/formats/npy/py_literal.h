// SPDX-License-Identifier: MIT
/// The literals of Python that headers of NumPy arrays are written in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

struct PyLiteral {
  enum class Kind : std::uint8_t { text, number, boolean, list, dictionary };
  Kind kind = Kind::list;
  std::string text;              ///< of a text
  std::uint64_t number = 0;      ///< of a number; of a boolean 0 or 1
  std::vector<PyLiteral> items;  ///< of a tuple or list; of a dictionary keys and values in turn

  /// The value of a key of a dictionary; null if it has none.
  const PyLiteral* find(std::string_view key) const;
};

/// Texts, whole numbers, True and False, tuples, lists and dictionaries in up to 8 levels; nothing for other text.
std::optional<PyLiteral> parse_py_literal(std::string_view text);

}  // namespace pointsweep
