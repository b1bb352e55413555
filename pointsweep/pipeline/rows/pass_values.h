// SPDX-License-Identifier: MIT
/// The values of the whole cloud that are known when a pass has ended.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Values of the whole cloud, by PlannedValue::number.
using CloudValues = std::map<std::size_t, std::vector<double>>;

/// Reduces the rows that a pass leaves to the values of the whole cloud that the pass plans (PlannedPass::values).
class PassValues {
 public:
  /// `input`: the schema of the cloud's records.
  PassValues(const PlannedPass& pass, const Schema& input);

  /// Returns whether add() also needs the cloud's records.
  bool needs_input() const { return needs_input_; }
  /// Adds `n` rows that the pass leaves: carried records, and records of the cloud, which may be null if not needed.
  /// `worker`: number of the thread in a parallel loop; several threads may call at once.
  void add(unsigned worker, const std::byte* carried, const std::byte* inputs, std::size_t n);
  void finish(CloudValues& into) const;
  /// Returns the state of each value of the pass, for finish_values() in another process.
  std::vector<std::vector<std::byte>> save() const;

 private:
  struct Component {
    Field field;
    bool carried;
  };
  struct Sum {
    PlannedValue value;
    std::vector<Component> reads;
    std::vector<std::unique_ptr<Accumulator>> parts;  ///< one accumulator for each thread

    std::unique_ptr<Accumulator> all() const;
  };
  Component component_of(const Attribute& attribute, std::size_t c, const PlannedPass& pass, const Schema& input);
  Component of_input(const Attribute& attribute, std::size_t c, const Schema& input);

  std::vector<Sum> sums_;
  std::size_t carried_bytes_, input_bytes_;
  bool needs_input_ = false;
};

/// Finishes the values of a pass whose rows are divided among several processes: `saved` has the result of
/// PassValues::save() of each process.
void finish_values(const PlannedPass& pass, const std::vector<std::vector<std::vector<std::byte>>>& saved,
                   CloudValues& into);

/// Returns the pass with the values of the whole cloud that its stages need, bound to `records` (PlannedPass::bind).
PlannedPass ready_pass(PlannedPass pass, const CloudValues& values, const Schema& records);

}  // namespace pointsweep
