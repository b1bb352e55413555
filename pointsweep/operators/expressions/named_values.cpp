// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/named_values.h"

#include <algorithm>
#include <cstring>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/operators/expressions/meant_value.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

constexpr std::string_view kAxes[] = {"x", "y", "z"};

std::optional<std::size_t> axis_of(std::string_view name) {
  const auto at = std::ranges::find(kAxes, name);
  if (at == std::end(kAxes)) return std::nullopt;
  return static_cast<std::size_t>(at - std::begin(kAxes));
}

bool is_64_bits(Type type) { return type == Type::i64 || type == Type::u64; }

/// The names that an expression may use, each once.
std::string names_of(const Schema& input, std::span<const Attribute> made) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const Field& field : input.fields)
    if (field.count == 1) add(field.name);
  for (const Attribute& a : made)
    for (const std::string& field : a.fields) add(field);
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

NamedValues::NamedValues(const Expression& expression, const std::string& place, const Schema& input,
                         std::span<const Attribute> made) {
  const auto refuse = [&](const Expression::Name& name, const std::string& what) {
    fail_usage("{}: '{}', column {}: {}.", place, expression.text(), name.column, what);
  };
  const auto source_of = [&](const Expression::Name& name) -> Source {
    const MeantValue meant = meant_value(name.text, input, made);
    if (meant.made != nullptr) return read(*meant.made, meant.component);
    if (const auto axis = axis_of(library_name_of(name.text))) return {-1, *axis};
    for (const Attribute& a : made)
      if (a.name == name.text)
        refuse(name, fmt::format("'{}' has the components {}; name one of these", a.name, fmt::join(a.fields, ", ")));
    if (meant.field == nullptr)
      refuse(name, fmt::format("there is no attribute '{}'; there are {}", name.text, names_of(input, made)));
    const Field& field = *meant.field;
    if (field.count != 1)
      refuse(name,
             fmt::format("'{}' is an array of {}, and a condition compares single values", name.text, field.count));
    const bool exact = field.is_plain() && is_64_bits(field.type);
    return read(scalar(field.name, exact ? field.type : Type::f64, "", ""), 0);
  };
  for (const Expression::Name& name : expression.names()) sources_.push_back(source_of(name));
}

NamedValues::Source NamedValues::read(Attribute attribute, std::size_t component) {
  const auto known = std::ranges::find(reads_, attribute.name, &Attribute::name);
  const auto index = static_cast<int>(known - reads_.begin());
  if (known == reads_.end()) reads_.push_back(std::move(attribute));
  return {index, component};
}

NamedValues::Batch::Batch(const NamedValues& names, const Neighborhoods& in, std::size_t first)
    : memory_(names.sources_.size()) {
  for (std::size_t n = 0; n < names.sources_.size(); ++n) {
    const auto [number, component] = names.sources_[n];
    Memory& out = memory_[n];
    if (number < 0) {
      for (std::size_t i = 0; i < in.size(); ++i) out.real.push_back(in.position(i)[static_cast<int>(component)]);
      values_.push_back({.real = out.real.data()});
      continue;
    }
    const Attribute& attribute = names.reads_[static_cast<std::size_t>(number)];
    const std::size_t bytes = size_of(attribute.type), stride = attribute.bytes();
    const std::byte* from = in.values<std::byte>(first + static_cast<std::size_t>(number)) + component * bytes;
    if (is_64_bits(attribute.type)) {
      out.whole.resize(in.size());
      for (std::size_t i = 0; i < in.size(); ++i) std::memcpy(&out.whole[i], from + i * stride, bytes);
      values_.push_back({.whole = out.whole.data(), .is_signed = attribute.type == Type::i64});
      continue;
    }
    const Field field{.name = "", .type = attribute.type};
    out.real.resize(in.size());
    for (std::size_t i = 0; i < in.size(); ++i) out.real[i] = value_of(field, from + i * stride);
    values_.push_back({.real = out.real.data()});
  }
}

}  // namespace pointsweep
