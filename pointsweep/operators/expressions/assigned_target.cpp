// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/assigned_target.h"

#include <algorithm>
#include <type_traits>

#include "pointsweep/fail.h"
#include "pointsweep/operators/expressions/meant_value.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {

std::string TargetRange::text() const {
  return is_whole ? fmt::format("{}, {:.0f} to {:.0f}", name_of(type), least, most) : std::string(name_of(type));
}

TargetRange range_of(Type type) {
  return with_type(type, [&]<class T>() {
    if constexpr (std::is_floating_point_v<T>) return TargetRange{.type = type};
    return TargetRange{.type = type,
                       .least = static_cast<double>(std::numeric_limits<T>::min()),
                       .most = static_cast<double>(std::numeric_limits<T>::max()),
                       .is_whole = true};
  });
}

TargetRange range_of(const Field& field) {
  TargetRange range = range_of(type_of_values(field));
  if (range.is_whole && field.bit_width > 0 && field.bit_width < 53) range.most = std::ldexp(1.0, field.bit_width) - 1;
  return range;
}

std::optional<AssignedTarget> target_of(const std::string& name, const Schema& input, std::span<const Attribute> made,
                                        const std::string& place) {
  const MeantValue meant = meant_value(name, input, made);
  if (meant.made != nullptr)
    return AssignedTarget{*meant.made, meant.component, range_of(meant.made->type), *meant.made};
  if (std::ranges::find(made, name, &Attribute::name) != made.end())
    fail_usage("{}: '{}' has several components; name one of them.", place, name);
  if (meant.field == nullptr) return std::nullopt;
  const Field& field = *meant.field;
  if (field.count != 1) fail_usage("{}: '{}' is an array of {}, not a single value.", place, field.name, field.count);
  const TargetRange range = range_of(field);
  const bool exact = field.is_plain() && (field.type == Type::i64 || field.type == Type::u64);
  return AssignedTarget{scalar(field.name, range.type, "1", "assigned"), 0, range,
                        scalar(field.name, exact ? field.type : Type::f64, "", "")};
}

}  // namespace pointsweep
