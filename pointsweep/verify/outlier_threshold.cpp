// SPDX-License-Identifier: MIT
#include "pointsweep/verify/outlier_threshold.h"

#include <algorithm>
#include <cmath>

#include "pointsweep/verify/chain_values.h"

namespace pointsweep {
namespace {

using formulas::Real;

template <class Use>
void for_each_finite(RowSource& source, const Field& field, const PhaseProgress& progress, Use use) {
  for (std::uint64_t row = 0; row < source.count();) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(source.block_rows(), source.count() - row));
    const std::span<const std::byte> records = source.read(row, n);
    for (std::size_t i = 0; i < n; ++i)
      if (const double v = value_of(field, records.data() + i * source.schema().stride); std::isfinite(v)) use(v);
    row += n;
    if (progress) progress("reading", row, source.count());
  }
}

constexpr const char* kMeanDistance = "mean_distance";

bool is_outlier(const StageOperator& op) { return name_of(op) == "outlier"; }

/// Returns the threshold of the finite mean distances, which for_each(use) passes to `use`. `type`: the type in which
/// the distances are stored.
template <class ForEach>
CloudThreshold threshold_of(ForEach for_each, Type type, const NamedOptions& options) {
  const std::string& definition = options.word("definition");
  Real sum = 0, n = 0, squares = 0;
  for_each([&](double v) { sum += v, n += 1; });
  const Real mean = sum / n;
  const bool of_open3d = definition == "open3d";
  for_each([&](double v) {
    if (v != 0 || !of_open3d) squares += (v - mean) * (v - mean);
  });
  const Real by = definition == "cloudcompare" ? n : n - 1;
  const Real deviation = by > 0 ? std::sqrt(squares / by) : 0;
  // Relative error of n additions in extended precision, and of distances that were rounded to text or float32.
  const Real lost = type == Type::f64 ? n * 0x1p-63L + 8 * formulas::kDouble : 4 * formulas::kSingle;
  const Real threshold = mean + options.number("multiplier") * deviation;
  return {threshold, lost * threshold};
}

}  // namespace

bool makes_distances_again(const std::vector<StageOperator>& operators) {
  const auto makes = [](const StageOperator& op) {
    return std::ranges::any_of(contract_of(op).makes, [](const Attribute& a) { return a.name == kMeanDistance; });
  };
  return std::any_of(std::ranges::find_if(operators, is_outlier), operators.end(), makes);
}

CloudThreshold outlier_threshold(RowSource& out, const std::vector<StageOperator>& operators, const std::string& prefix,
                                 const PhaseProgress& progress) {
  const auto op = std::ranges::find_if(operators, is_outlier);
  if (op == operators.end() || makes_distances_again(operators)) return {};
  const auto at = out.schema().find(prefix + kMeanDistance);
  if (!at) return {};
  const Field& field = out.schema().fields[*at];
  const auto for_each = [&](const auto& use) { for_each_finite(out, field, progress, use); };
  return threshold_of(for_each, field.type, setup_of(*operator_of(*op)).options);
}

CloudThreshold outlier_threshold_of_all(InputCloud& in, const std::vector<StageOperator>& operators,
                                        const SharedRule& rule, const NeighborRule& neighborhood,
                                        std::uint64_t memory_bytes) {
  const auto op = std::ranges::find_if(operators, is_outlier);
  if (op == operators.end()) return {};
  std::vector<StageOperator> before(operators.begin(), op);
  std::erase_if(before, [](const StageOperator& any) { return drops_rows(any); });
  const std::string name = kMeanDistance;
  ChainValues chain(before, {name}, in.schema(), rule);
  RowSource source(in);
  const PhaseProgress silent;
  CloudRows rows(source, source, -1, memory_bytes, silent, false);
  const std::vector<double> distances = chain.made_by_operators(name, rows, neighborhood);
  const auto for_each = [&](const auto& use) {
    for (const double v : distances)
      if (std::isfinite(v)) use(v);
  };
  return threshold_of(for_each, Type::f64, setup_of(*operator_of(*op)).options);
}

}  // namespace pointsweep
