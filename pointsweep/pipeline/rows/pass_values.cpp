// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/rows/pass_values.h"

#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/threads.h"

namespace pointsweep {
PassValues::PassValues(const PlannedPass& pass, const Schema& input)
    : carried_bytes_(pass.carried_bytes()), input_bytes_(input.stride) {
  for (const PlannedValue& value : pass.values) {
    Sum& sum = sums_.emplace_back();
    sum.value = value;
    for (const Attribute& a : value.reduction->reads())
      for (std::size_t c = 0; c < a.fields.size(); ++c)
        sum.reads.push_back(value.reduction->of_input() ? of_input(a, c, input) : component_of(a, c, pass, input));
    for (unsigned t = 0; t < thread_count(); ++t) sum.parts.push_back(value.reduction->start());
  }
}

PassValues::Component PassValues::component_of(const Attribute& attribute, std::size_t c, const PlannedPass& pass,
                                               const Schema& input) {
  std::size_t offset = 0;
  for (const Attribute& a : pass.carried) {
    if (a.name == attribute.name)
      return {{.name = "", .type = a.type, .offset = static_cast<std::uint32_t>(offset + c * size_of(a.type))}, true};
    offset += a.bytes();
  }
  return of_input(attribute, c, input);
}

PassValues::Component PassValues::of_input(const Attribute& attribute, std::size_t c, const Schema& input) {
  needs_input_ = true;
  return {input.fields[field_meant(input, attribute.fields[c]).value()], false};
}

void PassValues::add(unsigned worker, const std::byte* carried, const std::byte* inputs, std::size_t n) {
  for (Sum& sum : sums_) {
    std::vector<double> values;
    values.reserve(n * sum.reads.size());
    for (std::size_t i = 0; i < n; ++i)
      for (const Component& c : sum.reads)
        values.push_back(value_of(c.field, c.carried ? carried + i * carried_bytes_ : inputs + i * input_bytes_));
    sum.parts[worker]->add(values.data(), n);
  }
}

void PassValues::finish(CloudValues& into) const {
  for (const Sum& sum : sums_) into[sum.value.number] = sum.all()->finish();
}

std::vector<std::vector<std::byte>> PassValues::save() const {
  std::vector<std::vector<std::byte>> saved;
  for (const Sum& sum : sums_) saved.push_back(sum.all()->save());
  return saved;
}

std::unique_ptr<Accumulator> PassValues::Sum::all() const {
  std::unique_ptr<Accumulator> all = value.reduction->start();
  for (const auto& part : parts) all->merge(*part);
  return all;
}

void finish_values(const PlannedPass& pass, const std::vector<std::vector<std::vector<std::byte>>>& saved,
                   CloudValues& into) {
  for (std::size_t v = 0; v < pass.values.size(); ++v) {
    const std::unique_ptr<Accumulator> all = pass.values[v].reduction->start();
    for (const auto& of_part : saved) {
      if (of_part.size() != pass.values.size()) fail("a part has saved other values of the cloud than the run needs.");
      all->load(of_part[v]);
    }
    into[pass.values[v].number] = all->finish();
  }
}

PlannedPass ready_pass(PlannedPass pass, const CloudValues& values, const Schema& records) {
  for (std::size_t s = 0; s < pass.values_of_stages.size(); ++s) {
    if (pass.values_of_stages[s].empty()) continue;
    std::vector<std::vector<double>> given;
    for (const std::size_t number : pass.values_of_stages[s]) given.push_back(values.at(number));
    Stage& stage = pass.plan.stages[s];
    stage.op = std::get<std::shared_ptr<const LocalOperator>>(stage.op)->with_values(given);
  }
  pass.bind(records);
  return pass;
}

}  // namespace pointsweep
