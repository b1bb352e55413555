// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>

#include "pointsweep/verify/chain_values.h"

namespace pointsweep {
namespace {

using formulas::Real;

std::vector<double> value_in(InputCloud& cloud, const Reduction& reduction) {
  std::vector<Field> fields;
  for (const Attribute& a : reduction.reads())
    for (const std::string& name : a.fields) fields.push_back(cloud.schema().fields[cloud.schema().find(name).value()]);
  const std::unique_ptr<Accumulator> all = reduction.start();
  std::vector<double> values(fields.size());
  RowSource source(cloud);
  for_each_row(source, "reading", {}, [&](std::uint64_t, const std::byte* record) {
    for (std::size_t f = 0; f < fields.size(); ++f) values[f] = value_of(fields[f], record);
    all->add(values.data(), 1);
  });
  return all->finish();
}

constexpr const char* kMeanDistance = "mean_distance";

bool is_outlier(const StageOperator& op) { return name_of(op) == "outlier"; }

/// Returns the threshold of outliers from the finite mean distances. for_each(use) passes each of these distances to
/// `use`. `type`: the type in which the distances are stored.
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
  // Relative error: of n additions in extended precision and the rounding of each distance to float64; or of distances
  // that the output rounded to another type, such as float32.
  const Real lost = type == Type::f64 ? n * 0x1p-63L + 8 * formulas::kDouble : 4 * formulas::kSingle;
  const Real threshold = mean + options.number("multiplier") * deviation;
  return {threshold, lost * threshold};
}

}  // namespace

std::vector<StageOperator> with_input_values(std::vector<StageOperator> operators, InputCloud& cloud) {
  std::map<std::string, std::vector<double>> known;
  for (auto& op : operators) {
    const Contract contract = contract_of(op);
    const auto of_input = [](const auto& reduction) { return reduction->of_input(); };
    if (contract.values.empty() || !std::ranges::all_of(contract.values, of_input)) continue;
    std::vector<std::vector<double>> values;
    for (const auto& reduction : contract.values) {
      const auto [at, is_new] = known.try_emplace(reduction->text());
      if (is_new) at->second = value_in(cloud, *reduction);
      values.push_back(at->second);
    }
    op = std::get<std::shared_ptr<const LocalOperator>>(op)->with_values(values);
  }
  return operators;
}

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
  const auto for_each = [&](const auto& use) {
    for_each_row(out, "reading", progress, [&](std::uint64_t, const std::byte* record) {
      if (const double v = value_of(field, record); std::isfinite(v)) use(v);
    });
  };
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
