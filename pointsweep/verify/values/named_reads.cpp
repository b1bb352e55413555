// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/named_reads.h"

#include <algorithm>

namespace pointsweep {

std::vector<NamedRead> reads_of(const formulas::PlainExpression& expression, const std::vector<Attribute>& reads) {
  std::vector<NamedRead> named;
  for (const std::string& name : expression.names()) {
    const ReadValue value = read_of(name, reads);
    const Type type = value.attribute < 0 ? Type::f64 : reads[static_cast<std::size_t>(value.attribute)].type;
    named.push_back({value, type == Type::i64 || type == Type::u64});
  }
  return named;
}

std::vector<formulas::PossibleNumber> values_of(const std::vector<NamedRead>& names, const FormulaInput& in) {
  std::vector<formulas::PossibleNumber> values;
  for (const NamedRead& name : names) {
    const formulas::Estimate e = estimate_of(name.value, in);
    const formulas::Real v = component_of(e, name.value);
    formulas::Real low = v, high = v;
    if (e.error > 0) low = v - e.error, high = v + e.error;
    if (e.may_be_undefined) low = std::min<formulas::Real>(low, 0), high = std::max<formulas::Real>(high, 0);
    if (e.either_sign) low = std::min(low, -high), high = std::max(high, -low);
    if (e.is_open() || name.value.component > 2) low = -formulas::kInfinity, high = formulas::kInfinity;
    values.push_back({low, high, name.is_whole});
  }
  return values;
}

}  // namespace pointsweep
