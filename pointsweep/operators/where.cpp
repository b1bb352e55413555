// SPDX-License-Identifier: MIT
#include "pointsweep/operators/where.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <optional>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declaration.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

constexpr std::string_view kAxes[] = {"x", "y", "z"};

std::optional<std::size_t> axis_of(std::string_view name) {
  const auto at = std::ranges::find(kAxes, name);
  if (at == std::end(kAxes)) return std::nullopt;
  return static_cast<std::size_t>(at - std::begin(kAxes));
}

bool is_position(const Attribute& a) { return a.name == position_attribute().name; }
bool is_64_bits(Type type) { return type == Type::i64 || type == Type::u64; }

/// The names that a condition may use, each once.
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

/// The values of a name for one batch; the vectors are what the pointers point into.
struct NameValues {
  std::vector<double> real;
  std::vector<std::uint64_t> whole;
};

ExpressionValues positions(const Neighborhoods& in, std::size_t axis, NameValues& out) {
  for (std::size_t i = 0; i < in.size(); ++i) out.real.push_back(in.position(i)[static_cast<int>(axis)]);
  return {.real = out.real.data()};
}

ExpressionValues values_of(const std::byte* column, const Attribute& attribute, std::size_t component, std::size_t size,
                           NameValues& out) {
  const std::size_t bytes = size_of(attribute.type), stride = attribute.bytes();
  const std::byte* first = column + component * bytes;
  if (is_64_bits(attribute.type)) {
    out.whole.resize(size);
    for (std::size_t i = 0; i < size; ++i) std::memcpy(&out.whole[i], first + i * stride, bytes);
    return {.whole = out.whole.data(), .is_signed = attribute.type == Type::i64};
  }
  const Field field{.name = "", .type = attribute.type};
  out.real.resize(size);
  for (std::size_t i = 0; i < size; ++i) out.real[i] = value_of(field, first + i * stride);
  return {.real = out.real.data()};
}

/// Conditions that differ in blanks only are the same.
std::shared_ptr<Operator> make_where(const OptionValues& options, const Facts&) {
  auto where = std::make_shared<Where>(options.word("condition"), options.where());
  where->declare_options({{"condition", where->condition().canonical()}});
  return where;
}

}  // namespace

OperatorDeclaration where_declaration() {
  return {
      .name = "where",
      .meaning = "keeps the points for which a condition on attributes holds; later stages see neighbours among these",
      .options = {{.name = "condition",
                   .kind = OptionKind::condition,
                   .meaning = "attributes of the input or made before, numbers, + - * /, == != < <= > >=, && || !, and "
                              "parentheses; 'condition=' may be left out",
                   .required = true,
                   .positional = true,
                   .sample = "z > 0"}},
      .make = make_where,
      .undefined = "Points without a finite place are asked like all others: their coordinates are NaN or infinite.",
      .cost = "a pass over the rows, without a search; one more sweep if a later stage needs neighbours again",
      .example = "knn(k=12) | where(z > 0 && z < 100) | normals"};
}

Where::Where(std::string_view condition, std::string place) : condition_(condition, place), place_(std::move(place)) {}

void Where::apply(const Neighborhoods& in, Columns& out) const {
  assert(sources_.size() == condition_.names().size());
  std::vector<NameValues> memory(sources_.size());
  std::vector<ExpressionValues> values;
  for (std::size_t n = 0; n < sources_.size(); ++n) {
    const auto [attribute, component] = sources_[n];
    const auto a = static_cast<std::size_t>(std::max(attribute, 0));
    values.push_back(attribute < 0 ? positions(in, component, memory[n])
                                   : values_of(in.values<std::byte>(a), reads_[a], component, in.size(), memory[n]));
  }
  condition_.evaluate(values, out.column<std::uint8_t>(0));
}

std::shared_ptr<const Operator> Where::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<Where>(*this);
  bound->reads_.clear();
  bound->sources_.clear();
  for (const Expression::Name& name : condition_.names())
    bound->sources_.push_back(bound->source_of(name, input, made));
  return bound;
}

Where::Source Where::source_of(const Expression::Name& name, const Schema& input, std::span<const Attribute> made) {
  for (const Attribute& a : made) {
    const auto field = std::ranges::find(a.fields, name.text);
    if (is_position(a) || field == a.fields.end()) continue;
    return read(a, static_cast<std::size_t>(field - a.fields.begin()));
  }
  if (const auto axis = axis_of(library_name_of(name.text))) return {-1, *axis};
  for (const Attribute& a : made)
    if (a.name == name.text)
      refuse(name, fmt::format("'{}' has the components {}; name one of these", a.name, fmt::join(a.fields, ", ")));
  const auto at = input.find(name.text);
  if (!at) refuse(name, fmt::format("there is no attribute '{}'; there are {}", name.text, names_of(input, made)));
  const Field& field = input.fields[*at];
  if (field.count != 1)
    refuse(name, fmt::format("'{}' is an array of {}, and a condition compares single values", name.text, field.count));
  const bool exact = field.is_plain() && is_64_bits(field.type);
  return read(scalar(field.name, exact ? field.type : Type::f64, "", ""), 0);
}

Where::Source Where::read(Attribute attribute, std::size_t component) {
  const auto known = std::ranges::find(reads_, attribute.name, &Attribute::name);
  const auto index = static_cast<int>(known - reads_.begin());
  if (known == reads_.end()) reads_.push_back(std::move(attribute));
  return {index, component};
}

void Where::refuse(const Expression::Name& name, const std::string& what) const {
  fail_usage("{}: '{}', column {}: {}.", place_, condition_.text(), name.column, what);
}

}  // namespace pointsweep
