// SPDX-License-Identifier: MIT
/// Operator that passes the neighbourhoods of every batch to a function.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "pointsweep/operator.h"

namespace pointsweep {

/// Makes "neighbor_count", u32, and passes the neighbourhoods to `take`. `take` is called by many threads at once and
/// must copy what it needs of a batch. A run may pass a point twice, with the same neighbours.
class NeighborSink final : public LocalOperator {
 public:
  NeighborSink(std::string name, std::function<void(const Neighborhoods&)> take)
      : name_(std::move(name)), take_(std::move(take)) {}
  std::string name() const override { return name_; }
  Contract contract() const override {
    return {.makes = {scalar("neighbor_count", Type::u32, "1", "number of neighbours")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const auto counts = out.column<std::uint32_t>(0);
    for (std::size_t i = 0; i < in.size(); ++i) counts[i] = static_cast<std::uint32_t>(in.count(i));
    take_(in);
  }

 private:
  std::string name_;
  std::function<void(const Neighborhoods&)> take_;
};

}  // namespace pointsweep
