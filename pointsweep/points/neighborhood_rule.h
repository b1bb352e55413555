// SPDX-License-Identifier: MIT
/// How large the neighbourhood of each point is, where points differ in that.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/points/attribute.h"
#include "pointsweep/points/neighborhoods.h"
#include "pointsweep/points/option_value.h"

namespace pointsweep {

/// Shortens the list of a point's neighbours. The search finds the largest neighbourhood that any point may have,
/// nearest first; the rule keeps the first m of each point, with m its choice. These are exact because the list is: the
/// first m of the k nearest are the m nearest.
///
/// Like an operator, a rule is a pure function of a point, its attributes and its list. It runs once per point,
/// before all stages. The cost of the search is that of the largest neighbourhood.
class NeighborhoodRule {
 public:
  virtual ~NeighborhoodRule() = default;
  /// What it keeps, to end the sentence "of these ...".
  virtual std::string meaning() const = 0;
  /// Attributes of the point itself that it looks at; the input has them.
  virtual std::vector<Attribute> reads() const = 0;
  /// The options that tell rules of one class apart, e.g. {{"k_from", "scale"}}: a run with other options is another
  /// run.
  virtual Options options() const { return {}; }
  /// Sets counts[i] to how many neighbours point i keeps, at most in.count(i). Called from many threads at once.
  virtual void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const = 0;
};

/// A rule that several neighbourhoods share, or none. A shared pointer would do, were its destructor not inlined: GCC
/// 12 then warns wrongly, in code that writes a chain in braces, that it destroys what may never have been made.
class SharedRule {
 public:
  SharedRule() = default;
  template <class Rule>
  SharedRule(std::shared_ptr<Rule> rule) : rule_(std::move(rule)) {}
  SharedRule(const SharedRule&) = default;
  SharedRule& operator=(const SharedRule&) = default;
  ~SharedRule();

  explicit operator bool() const { return rule_ != nullptr; }
  const NeighborhoodRule* operator->() const { return rule_.get(); }
  const NeighborhoodRule& operator*() const { return *rule_; }

 private:
  std::shared_ptr<const NeighborhoodRule> rule_;
};

}  // namespace pointsweep
