// SPDX-License-Identifier: MIT
/// The parts of voxel(keep=centroid): means of each voxel beside the row that stays, the attributes that they become,
/// and the rows that are left.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators/ordered_operator.h"

namespace pointsweep {

/// An attribute of which means are taken. Others keep the value of the row that stays.
struct AveragedAttribute {
  Attribute made;                ///< as it is made again: its type and fields are those it had
  std::vector<Attribute> reads;  ///< itself, or scalars of the input that are its fields
  bool is_direction = false;     ///< the mean is made a unit vector again
};

/// Of the fields of `input` and of what is made: normals, floating-point numbers, colours and intensities; but no
/// vectors without a sign, arrays, packed or scaled fields.
std::vector<AveragedAttribute> averaged_attributes(const Schema& input, std::span<const Attribute> made);

/// Makes "voxel_means" of the row of each voxel that keep=center would keep: 1, the mean position, and the means of
/// AveragedAttribute::reads. Of all other rows it is 0.
class VoxelMeans final : public OrderedOperator {
 public:
  explicit VoxelMeans(double size) : size_(size) {}
  std::string name() const override { return "voxel"; }
  Contract contract() const override;
  std::shared_ptr<const Operator> bound(const Schema& input, std::span<const Attribute> made) const override;
  Vec3 place_of(Vec3 position) const override;
  std::unique_ptr<OrderedWork> work(const OrderedSetup& setup) const override;
  std::uint64_t least_bytes(std::span<const Vec3>, int) const override { return 1 << 20; }
  double size() const { return size_; }

 private:
  double size_;
  std::vector<AveragedAttribute> averaged_;
};

/// Makes the position and the attributes out of "voxel_means". A point without a finite place keeps its own.
class TakeVoxelMeans final : public Operator {
 public:
  std::string name() const override { return "voxel"; }
  Contract contract() const override;
  std::shared_ptr<const Operator> bound(const Schema& input, std::span<const Attribute> made) const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  const std::vector<AveragedAttribute>& averaged() const { return averaged_; }

 private:
  std::vector<AveragedAttribute> averaged_;
};

/// Keeps the rows that have means, and points without a finite place.
class KeepVoxelMeans final : public Operator {
 public:
  std::string name() const override { return "voxel"; }
  Contract contract() const override;
  std::shared_ptr<const Operator> bound(const Schema& input, std::span<const Attribute> made) const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  std::vector<Attribute> reads_;
};

}  // namespace pointsweep
