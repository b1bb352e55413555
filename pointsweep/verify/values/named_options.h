// SPDX-License-Identifier: MIT
/// The options of an operator or of a rule, by name, as formulas read them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/option.h"

namespace pointsweep {

class NamedOptions {
 public:
  /// `owner`: the name of the operator or rule, which begins messages, e.g. "density".
  NamedOptions(std::string owner, Options all) : owner_(std::move(owner)), all_(std::move(all)) {}

  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// Each of the next four functions returns the value of an option. It throws UsageError if the option is absent or of
  /// another kind, which shows that the owner only shares its name with an operator of the library.
  double number(std::string_view name) const;
  std::uint64_t whole(std::string_view name) const;
  const std::string& word(std::string_view name) const;
  Vec3 point(std::string_view name) const;
  /// Returns the numbers of an option such as "1,2.5"; "inf" and "nan" are numbers, too.
  std::vector<double> numbers(std::string_view name) const;

  std::optional<double> number_if_given(std::string_view name) const {
    return has(name) ? std::optional(number(name)) : std::nullopt;
  }

 private:
  const OptionValue* find(std::string_view name) const;
  template <class T>
  const T& value(std::string_view name) const;

  std::string owner_;
  Options all_;
};

}  // namespace pointsweep
