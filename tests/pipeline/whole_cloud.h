// SPDX-License-Identifier: MIT
/// A slow and obvious evaluation of a chain: every operator runs on the whole cloud in memory, one stage after another,
/// with neighbours from all pairs. It uses no code of the engine.
#pragma once

#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"

namespace pointsweep {

class WholeCloud {
 public:
  using Column = std::vector<std::byte>;

  WholeCloud(std::vector<Vec3> points, const Chain& chain) : input_(points), points_(std::move(points)) {
    neighborhood_ = with_named_neighborhoods(chain).neighborhood;
    begin_sweep();
    for (const ChainStage& stage : chain.stages) {
      if (const auto* update = std::get_if<Reneighbor>(&stage)) {
        if (update->neighborhood) neighborhood_ = *update->neighborhood;
        begin_sweep();
      } else if (const auto* op = std::get_if<std::shared_ptr<const LocalOperator>>(&stage)) {
        const std::vector<std::vector<double>> values = values_for(**op);
        apply(values.empty() ? **op : *(*op)->with_values(values));
      }
    }
  }

  const std::vector<Vec3>& points() const { return points_; }
  /// Returns the values of an attribute, all components of a point side by side.
  template <class T>
  std::vector<T> values(const std::string& name) const {
    const Column& column = made_.at(name);
    std::vector<T> values(column.size() / sizeof(T));
    std::memcpy(values.data(), column.data(), column.size());
    return values;
  }

 private:
  /// Returns the values of the whole input that the operator needs.
  std::vector<std::vector<double>> values_for(const LocalOperator& op) const {
    std::vector<std::vector<double>> values;
    const Contract contract = op.contract();
    for (const auto& reduction : contract.values) {
      const auto all = reduction->start();
      all->add(&input_.data()->x, input_.size());
      values.push_back(all->finish());
    }
    return values;
  }

  void begin_sweep() {
    lists_ = brute_force_neighbors(points_, neighborhood_.k, neighborhood_.radius);
    moved_ = false;
    is_somewhere_.clear();
    for (const Vec3& p : points_) is_somewhere_.push_back(is_finite(p));
  }

  void apply(const LocalOperator& op) {
    const Contract contract = op.contract();
    std::vector<Column> own, of_neighbors;
    for (const Attribute& a : contract.reads) own.push_back(made_.at(a.name));
    for (const Attribute& a : contract.reads_neighbors) of_neighbors.push_back(made_.at(a.name));
    const InCoreResult result = InCoreCloud(points_, lists_, kCellCapacity, moved_).apply(op, own, of_neighbors);
    for (std::size_t m = 0; m < contract.makes.size(); ++m) take(contract.makes[m], result.columns[m]);
  }

  /// Stores a column. Points that were not finite when the sweep began are not moved and get the fill.
  void take(const Attribute& attribute, Column column) {
    const std::size_t bytes = attribute.bytes();
    const bool moves = attribute.name == position_attribute().name;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      std::byte* value = column.data() + i * bytes;
      if (!is_somewhere_[i] && moves) std::memcpy(value, &points_[i], sizeof(Vec3));
      if (!is_somewhere_[i] && !moves) std::fill_n(value, bytes, attribute.fill);
      if (moves) std::memcpy(&points_[i], value, sizeof(Vec3));
    }
    moved_ = moved_ || moves;
    made_[attribute.name] = std::move(column);
  }

  std::vector<Vec3> input_, points_;
  Neighborhood neighborhood_;
  std::vector<std::vector<std::uint32_t>> lists_;
  std::vector<bool> is_somewhere_;
  bool moved_ = false;  ///< true if points have moved since the lists were found
  std::map<std::string, Column> made_;
};

}  // namespace pointsweep
