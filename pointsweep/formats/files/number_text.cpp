// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/number_text.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace pointsweep {
namespace {

/// Reads a non-finite number in the notation of old C libraries of Windows: "1.#QNAN", "-1.#IND00", "1.#INF".
template <class T>
bool parse_windows_word(std::string_view word, T& value) {
  const bool negative = word.starts_with('-');
  if (negative) word.remove_prefix(1);
  if (!word.starts_with("1.#")) return false;
  value = word.substr(3).starts_with("INF") ? std::numeric_limits<T>::infinity() : std::numeric_limits<T>::quiet_NaN();
  if (negative) value = -value;
  return true;
}

template <class T>
bool parse_floating(std::string_view word, T& value) {
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc{} && stop == end) return true;
  if (error == std::errc::result_out_of_range && stop == end) {
    long double wide = 0;
    const auto again = std::from_chars(word.data(), end, wide);
    if (again.ec == std::errc{}) {
      value = static_cast<T>(wide);
    } else {
      // The number is beyond the range of long double. It becomes 0 if its exponent is negative or, without an
      // exponent, if no digit but 0 stands before the point; otherwise it becomes infinite.
      const std::size_t exponent = word.find_first_of("eE"), digit = word.find_first_not_of("-0");
      const bool tiny = exponent != word.npos ? word.substr(exponent + 1).starts_with('-') : word[digit] == '.';
      value = std::copysign(tiny ? T{0} : std::numeric_limits<T>::infinity(), word.starts_with('-') ? T{-1} : T{1});
    }
    return true;
  }
  return parse_windows_word(word, value);
}

template <class T>
bool parse_integer(std::string_view word, T& value) {
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error == std::errc{} && stop == end) return true;
  double near = 0;
  // GCC 12 reads beyond the word when it parses "inf" or "nan" as a long double.
  if (!parse_floating(word, near) || !std::isfinite(near)) return false;
  // A double does not hold every 64-bit integer; parsing a long double takes more time.
  long double wide = near;
  if (std::abs(near) >= 0x1p53) parse_floating(word, wide);
  if (wide != std::nearbyint(wide)) return false;
  // The upper end is excluded since the largest 64-bit integers round up where a long double is a double.
  const long double upper = std::ldexp(1.0L, std::numeric_limits<T>::digits);
  if (!(wide >= static_cast<long double>(std::numeric_limits<T>::min()) && wide < upper)) return false;
  value = static_cast<T>(wide);
  return true;
}

}  // namespace

template <class T>
bool parse_number(std::string_view word, T& value) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  if constexpr (std::is_floating_point_v<T>) {
    return parse_floating(word, value);
  } else {
    return parse_integer(word, value);
  }
}

template bool parse_number(std::string_view, std::int8_t&);
template bool parse_number(std::string_view, std::uint8_t&);
template bool parse_number(std::string_view, std::int16_t&);
template bool parse_number(std::string_view, std::uint16_t&);
template bool parse_number(std::string_view, std::int32_t&);
template bool parse_number(std::string_view, std::uint32_t&);
template bool parse_number(std::string_view, std::int64_t&);
template bool parse_number(std::string_view, std::uint64_t&);
template bool parse_number(std::string_view, float&);
template bool parse_number(std::string_view, double&);

}  // namespace pointsweep
