// SPDX-License-Identifier: MIT
/// Numbers in texts, as std::from_chars() reads them: no blanks and no plus sign before the number.
/// formats/files/number_text.h reads the numbers of point files.
#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string_view>
#include <system_error>

namespace pointsweep {

/// Removes the number at the start of `text` and returns it; absent if there is none or T cannot hold it.
template <class T>
std::optional<T> take_number(std::string_view& text) {
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

/// Returns the number that `text` is; absent if it is none or T cannot hold it.
template <class T>
std::optional<T> number_from(std::string_view text) {
  const std::optional<T> number = take_number<T>(text);
  return text.empty() ? number : std::nullopt;
}

}  // namespace pointsweep
