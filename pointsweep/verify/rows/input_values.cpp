// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/input_values.h"

#include <algorithm>
#include <map>
#include <string>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

std::vector<double> value_in(InputCloud& cloud, const Reduction& reduction) {
  constexpr std::uint64_t kRows = 8192;
  const Schema& schema = cloud.schema();
  std::vector<Field> fields;
  for (const Attribute& a : reduction.reads())
    for (const std::string& name : a.fields) fields.push_back(schema.fields[schema.find(name).value()]);
  const std::unique_ptr<Accumulator> all = reduction.start();
  std::vector<std::byte> records(kRows * schema.stride);
  std::vector<double> values;
  for (std::uint64_t row = 0; row < cloud.count();) {
    stop_if_cancelled();
    const std::size_t n = cloud.read(row, records);
    if (n == 0) fail("{}: ends before its last point.", cloud.readers().front()->info().path.string());
    values.clear();
    for (std::size_t i = 0; i < n; ++i)
      for (const Field& field : fields) values.push_back(value_of(field, records.data() + i * schema.stride));
    all->add(values.data(), n);
    row += n;
  }
  return all->finish();
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

}  // namespace pointsweep
