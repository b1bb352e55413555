// SPDX-License-Identifier: MIT
/// Attributes taken from another cloud.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/change/taken_value.h"

namespace pointsweep {

/// An attribute that `take` makes. Some or all of its components come from the other cloud.
struct TakeTarget {
  Attribute made;
  std::optional<Attribute> old;  ///< previous version, which the operator reads; absent for a new attribute
};

/// Gives points the attributes of the nearest points of another cloud.
class Take final : public InOrderOperator {
 public:
  /// Messages about options in conflict begin with `place`. Throws UsageError for options out of range or in conflict,
  /// and for an attribute that is a coordinate or named twice.
  explicit Take(TakeOptions options, std::string place = "take");

  std::string name() const override { return "take"; }
  InOrderContract in_order_contract() const override;
  std::string other_cloud() const override { return options_.cloud; }
  std::vector<Attribute> other_reads() const override;
  std::optional<Reach> reach() const override { return Reach{}; }
  std::optional<Reach> other_reach() const override;
  /// Throws UsageError for an attribute that the other cloud lacks, with the most similar names, and for a field that
  /// is an array or named twice.
  std::shared_ptr<const InOrderOperator> bound_to_other(const Schema& other) const override;
  /// Throws UsageError if the type of an attribute cannot hold `missing`, or if the type of a new attribute has no
  /// value for points without a result.
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;

 private:
  void find_target(TakenAttribute& taken, const Schema& input, std::span<const Attribute> made);
  void require_missing_value(const TakenAttribute& taken) const;

  TakeOptions options_;
  std::string place_;
  std::vector<TakenAttribute> taken_;
  std::vector<TakeTarget> targets_;
};

}  // namespace pointsweep
