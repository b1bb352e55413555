// SPDX-License-Identifier: MIT
#include "pointsweep/operators/thinning/voxel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pointsweep/math/mix.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

namespace pointsweep {
namespace {

const OptionTable<VoxelOptions>& voxel_options() {
  static const OptionTable<VoxelOptions> table = {
      option("size", &VoxelOptions::size, "edge length of the cubes, whose faces lie at multiples of it",
             {.least = kAboveZero, .unit = "length", .required = true, .positional = true, .sample = 0.5}),
      option("keep", &VoxelOptions::keep,
             "point that a cube keeps: the one nearest to its centre, one chosen by a hash, or the one nearest to its "
             "centre with the means of the cube",
             {.choices = {"center", "hash", "centroid"}})};
  return table;
}

/// Keeps the best point of each voxel. Holds the best point of the current voxel so far.
class OneOfEachVoxel final : public InOrderWork {
 public:
  OneOfEachVoxel(double size, VoxelKeep keep) : size_(size), keep_(keep) {}

  void add(unsigned, const OrderedPoints& points, Findings& findings) override {
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      const VoxelCandidate next = candidate(points.places[i], points.positions[i], points.rows[i]);
      const bool same = any_ && points.places[i] == voxel_;
      if (same) findings.dropped.push_back(next < best_ ? best_.row : next.row);
      if (!same || next < best_) best_ = next;
      voxel_ = points.places[i];
      any_ = true;
    }
  }

 private:
  VoxelCandidate candidate(Vec3 voxel, Vec3 p, std::uint64_t row) const {
    if (keep_ == VoxelKeep::hash) return {0, coordinate_hash(p, kVoxelSeed), p, row};
    return nearest_to_center(voxel, size_, p, row);
  }

  double size_;
  VoxelKeep keep_;
  bool any_ = false;
  Vec3 voxel_;
  VoxelCandidate best_;
};

}  // namespace

OperatorDeclaration voxel_declaration() {
  return {
      .name = "voxel",
      .meaning = "keeps one point in each cube of a grid; later stages see neighbours among those kept",
      .options = voxel_options().declarations(),
      .make = voxel_options().maker<Voxel>(),
      .formula =
          "Voxel of p: (⌊x / size⌋, ⌊y / size⌋, ⌊z / size⌋), quotients rounded to float64: a point on a "
          "face belongs to the voxel above it. The grid does not depend on the cloud.\n"
          "keep=center: the least |p - c|², ((dx² + dy²) + dz²) in float64, c = (voxel + 0.5) * size.\n"
          "keep=hash: the least hash of decimate, with the seed 0x766f78656c.\n"
          "Of equal ones the point of the least x, then y, then z, then input row.\n"
          "keep=centroid: the row of keep=center, at the mean of the points of the voxel. Floating-point numbers, "
          "intensity and colours become means too: m = (Σ v) / n of the n finite values, limited to their range; Σ is "
          "exact and rounded once to float64; intensity and colours are rounded to whole numbers, halves to even.\n"
          "Normals: the mean, divided by its length; 0 where that is 0. All else is that of the row: whole "
          "numbers (classification, return number, ids), directions without a sign, arrays, scaled fields.",
      .undefined =
          "Points without a finite place all stay, with the values they have. The mean of values none of which is "
          "finite is NaN.",
      .cost =
          "a pass that puts the points in order by voxel, without a search; memory does not depend on the size. "
          "keep=centroid: the averaged attributes travel with the points",
      .example = "knn(k=12) | voxel(0.5) | normals"};
}

ChainStage operators::voxel(const VoxelOptions& options) { return std::make_shared<Voxel>(options); }

Voxel::Voxel(const VoxelOptions& options) : options_(options) { voxel_options().declare(*this, options); }

InOrderContract Voxel::in_order_contract() const {
  InOrderContract contract{.drops_rows = true, .places = Places::of_operator, .arrival = "those of a voxel together"};
  if (options_.keep != VoxelKeep::centroid) return contract;
  contract.makes = {position_attribute()};
  for (const AveragedAttribute& a : averaged_) {
    contract.reads.insert(contract.reads.end(), a.reads.begin(), a.reads.end());
    contract.makes.push_back(a.made);
  }
  return contract;
}

std::shared_ptr<const InOrderOperator> Voxel::bound(const Schema& input, std::span<const Attribute> made) const {
  if (options_.keep != VoxelKeep::centroid) return nullptr;
  auto bound = std::make_shared<Voxel>(*this);
  bound->averaged_ = averaged_attributes(input, made);
  return bound;
}

std::unique_ptr<InOrderWork> Voxel::start(const InOrderSetup&) const {
  if (options_.keep == VoxelKeep::centroid) return means_of_voxels(options_.size, averaged_);
  return std::make_unique<OneOfEachVoxel>(options_.size, options_.keep);
}

std::uint64_t Voxel::least_bytes(const CloudEstimate&) const {
  return options_.keep == VoxelKeep::centroid ? 1 << 20 : 0;
}

Vec3 Voxel::place_of(Vec3 position) const { return voxel_of_position(position, options_.size); }

Vec3 voxel_of_position(Vec3 position, double size) {
  constexpr double kMost = std::numeric_limits<double>::max();
  const auto number = [&](double c) { return std::clamp(std::floor(c / size), -kMost, kMost); };
  return {number(position.x), number(position.y), number(position.z)};
}

}  // namespace pointsweep
