// SPDX-License-Identifier: MIT
#include "pointsweep/program/quantities.h"

#include <cmath>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {
namespace {

constexpr std::string_view kPrefixes = "KMGT";

std::optional<double> take_finite(std::string_view& text) {
  const auto value = take_number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Parses a whole number, exact to 64 bits, or a decimal number with K, M, G or T for a power of `base`, whose product
/// is rounded down. A decimal number without a letter must be whole.
std::optional<std::uint64_t> scaled(std::string_view text, double base) {
  if (const auto whole = number_from<std::uint64_t>(text)) return whole;
  const auto number = take_finite(text);
  if (!number || *number < 0 || text.size() > 1) return std::nullopt;
  double factor = 1;
  if (!text.empty()) {
    const auto power = kPrefixes.find(static_cast<char>(text[0] & ~0x20));
    if (power == std::string_view::npos) return std::nullopt;
    factor = std::pow(base, static_cast<double>(power + 1));
  }
  const double value = *number * factor;
  if (value >= 0x1p63 || (text.empty() && value != std::floor(value))) return std::nullopt;
  return static_cast<std::uint64_t>(value);
}

/// Returns "4G" for "4G", "4GB" and "4GiB", "800" for "800B". Removes an i before the B only after a prefix.
std::string_view without_byte(std::string_view text) {
  if (!text.ends_with('B') && !text.ends_with('b')) return text;
  text.remove_suffix(1);
  const bool has_i = text.size() > 1 && (text.ends_with('i') || text.ends_with('I'));
  if (has_i && kPrefixes.find(static_cast<char>(text[text.size() - 2] & ~0x20)) != std::string_view::npos)
    text.remove_suffix(1);
  return text;
}

std::string three_digits(double value, double base) {
  std::size_t power = 0;
  for (; value >= 0.9995 * base && power < kPrefixes.size(); ++power) value /= base;
  return power == 0 ? fmt::format("{:.0f}", value)
                    : fmt::format("{:.{}f}{}", value,
                                  value < 9.995   ? 2
                                  : value < 99.95 ? 1
                                                  : 0,
                                  kPrefixes[power - 1]);
}

}  // namespace

std::uint64_t parse_size(std::string_view option, std::string_view text) {
  std::string_view rest = text;
  const std::optional<double> bare = take_finite(rest);
  if (bare && *bare >= 0 && rest.empty())
    fail_usage("{}: '{}' has no unit: add B, K, M, G or T (powers of 1024; 4G, 4GB and 4GiB are the same).", option,
               text);
  const auto size = scaled(without_byte(text), 1024);
  if (!size || *size == 0) fail_usage("{}: '{}' is not a size such as 256M, 1.5G or 4GiB.", option, text);
  return *size;
}

std::uint64_t parse_count(std::string_view option, std::string_view text) {
  const auto count = scaled(text, 1000);
  if (!count) fail_usage("{}: '{}' is not a whole number such as 8, 500000 or 20M.", option, text);
  return *count;
}

Vec3 parse_vector(std::string_view option, std::string_view text) {
  std::string_view rest = text;
  Vec3 v;
  for (int axis = 0; axis < 3; ++axis) {
    const auto number = take_finite(rest);
    const bool separated = axis == 2 ? rest.empty() : rest.starts_with(',');
    if (!number || !separated) fail_usage("{}: '{}' is not of the form X,Y,Z.", option, text);
    v[axis] = *number;
    if (axis < 2) rest.remove_prefix(1);
  }
  return v;
}

std::vector<std::string> parse_names(std::string_view option, const std::string& text) {
  std::vector<std::string> names = words_of(text);
  for (const std::string& name : names)
    if (name.empty()) fail_usage("{}: '{}' is not a list of attributes such as normal,splat_length.", option, text);
  return names;
}

std::string size_text(std::uint64_t bytes) { return three_digits(static_cast<double>(bytes), 1024); }

std::string count_text(double count) {
  return count < 9999.5 ? fmt::format("{:.0f}", count) : three_digits(count, 1000);
}

std::string grouped_text(std::uint64_t count) {
  std::string text = std::to_string(count);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, ",");
  return text;
}

std::string duration_text(double seconds) {
  const auto s = static_cast<std::uint64_t>(std::max(0.0, std::round(seconds)));
  if (s >= 3600) return fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
  return fmt::format("{}:{:02}", s / 60, s % 60);
}

}  // namespace pointsweep
