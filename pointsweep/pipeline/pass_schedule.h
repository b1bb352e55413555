// SPDX-License-Identifier: MIT
/// Which pass each stage of a chain runs in.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/pipeline/planned_sweeps.h"

namespace pointsweep {

/// A pass of which only the stages are known.
struct ScheduledPass {
  PassKind kind = PassKind::sweep;
  Chain chain;
  bool selects = false;
  std::vector<PlannedValue> values;
  std::vector<std::vector<std::size_t>> values_of_stages;  ///< by operator of `chain`
};

/// Takes the stages of a chain one after another. Each comes into the first pass in which every attribute and every
/// value it reads is known, no later stage having remade one; a select and a new neighbourhood end all passes before
/// them. So two values that do not depend on each other are found by one pass.
class PassSchedule {
 public:
  /// `input_values`: a stage before the first select needs a value of the input, for which the rows are read first.
  PassSchedule(Neighborhood neighborhood, bool input_values) : neighborhood_(std::move(neighborhood)) {
    if (input_values) new_pass(PassKind::rows);
  }
  void add(const std::shared_ptr<const Operator>& op);
  /// Later stages find neighbours at the positions of now.
  void renew(const std::optional<Neighborhood>& neighborhood);
  std::vector<ScheduledPass> passes() && { return std::move(passes_); }

 private:
  /// When an attribute was made and last read, by number of the pass.
  struct Use {
    std::size_t made = 0, read = 0;
    bool is_made = false;  ///< by a stage of this segment
  };
  void add_select(const std::shared_ptr<const Operator>& op);
  std::size_t earliest(const Contract& contract) const;
  std::size_t pass_for(const Operator& op, const Contract& contract, std::size_t earliest);
  std::size_t find_input_value(const std::shared_ptr<const Reduction>& reduction, std::size_t& earliest);
  std::size_t find_value(const std::shared_ptr<const Reduction>& reduction, std::size_t& earliest);
  std::vector<std::size_t> find_values(const Contract& contract, std::size_t& earliest);
  void require_search_positions(const Operator& op, std::size_t pass) const;
  std::size_t known_after(const Reduction& reduction) const;
  void note_use(const Contract& contract, std::size_t pass);
  ScheduledPass& new_pass(PassKind kind);
  void begin_segment();

  Neighborhood neighborhood_;
  std::vector<ScheduledPass> passes_;
  std::size_t segment_ = 0;          ///< first pass after the last select or renewal
  std::map<std::string, Use> used_;  ///< in this segment, by attribute
  std::size_t values_ = 0;           ///< in the whole chain
  /// Of the rows left now: the numbers of the values of the input by text, and the passes that find them.
  std::map<std::string, std::pair<std::size_t, std::size_t>> input_values_;
};

}  // namespace pointsweep
