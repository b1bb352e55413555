// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/named_options.h"

#include <algorithm>
#include <charconv>

#include "pointsweep/fail.h"

namespace pointsweep {

const OptionValue* NamedOptions::find(std::string_view name) const {
  const auto at = std::ranges::find(all_, name, &Option::name);
  return at == all_.end() ? nullptr : &at->value;
}

template <class T>
const T& NamedOptions::value(std::string_view name) const {
  const OptionValue* const found = find(name);
  if (found == nullptr || !std::holds_alternative<T>(*found))
    fail_usage(
        "verify: '{}' has no option '{}' of the kind that the operator of the library has; an operator of your "
        "own needs a name that no operator of the library has.",
        owner_, name);
  return std::get<T>(*found);
}

double NamedOptions::number(std::string_view name) const { return value<double>(name); }
std::uint64_t NamedOptions::whole(std::string_view name) const { return value<std::uint64_t>(name); }
const std::string& NamedOptions::word(std::string_view name) const { return value<std::string>(name); }
Vec3 NamedOptions::point(std::string_view name) const { return value<Vec3>(name); }

std::vector<double> NamedOptions::numbers(std::string_view name) const {
  const std::string& list = word(name);
  std::vector<double> numbers;
  const char* at = list.data();
  const char* const end = at + list.size();
  for (double number = 0; at < end; ++at) {
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc()) break;
    numbers.push_back(number);
    at = next;
  }
  return numbers;
}

}  // namespace pointsweep
