// SPDX-License-Identifier: MIT
#include "pointsweep/operators/voxel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "pointsweep/fail.h"
#include "pointsweep/math/coordinate_hash.h"
#include "pointsweep/operators/declaration.h"

namespace pointsweep {
namespace {

/// What decides between two points of a voxel; the lesser is kept.
struct Candidate {
  double distance2 = 0;  ///< to the centre; 0 where the hash decides
  std::uint64_t hash = 0;
  Vec3 position;
  std::uint64_t row = 0;

  bool operator<(const Candidate& other) const { return key() < other.key(); }

 private:
  std::tuple<double, std::uint64_t, double, double, double, std::uint64_t> key() const {
    return {distance2, hash, position.x, position.y, position.z, row};
  }
};

/// Knows the best point so far of the voxel whose points come now.
class OneOfEachVoxel final : public Thinning {
 public:
  OneOfEachVoxel(double size, VoxelKeep keep) : size_(size), keep_(keep) {}

  void add(const OrderedPoints& points, Decided& decided) override {
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      const Candidate next = candidate(points.places[i], points.positions[i], points.rows[i]);
      const bool same = any_ && points.places[i] == voxel_;
      if (same) decided.left_out.push_back(next < best_ ? best_.row : next.row);
      if (!same || next < best_) best_ = next;
      voxel_ = points.places[i];
      any_ = true;
    }
  }
  void finish(Decided&) override {}

 private:
  Candidate candidate(Vec3 voxel, Vec3 p, std::uint64_t row) const {
    if (keep_ == VoxelKeep::hash) return {0, coordinate_hash(p, kVoxelSeed), p, row};
    const Vec3 center{(voxel.x + 0.5) * size_, (voxel.y + 0.5) * size_, (voxel.z + 0.5) * size_};
    return {distance2(p, center), 0, p, row};
  }

  double size_;
  VoxelKeep keep_;
  bool any_ = false;
  Vec3 voxel_;
  Candidate best_;
};

std::shared_ptr<Operator> make_voxel(const OptionValues& options, const Facts&) {
  const VoxelKeep keep = options.word("keep") == "hash" ? VoxelKeep::hash : VoxelKeep::center;
  return std::make_shared<Voxel>(options.number("size"), keep);
}

}  // namespace

OperatorDeclaration voxel_declaration() {
  return {.name = "voxel",
          .meaning = "keeps one point in each cube of a grid; later stages see neighbours among those kept",
          .options = {{.name = "size",
                       .kind = OptionKind::number,
                       .meaning = "length of the edges of the cubes, whose faces lie at multiples of it",
                       .least = 1e-9,
                       .unit = "length",
                       .required = true,
                       .positional = true,
                       .sample = 0.5},
                      {.name = "keep",
                       .kind = OptionKind::choice,
                       .preset = std::string("center"),
                       .meaning = "the point nearest to the centre of the cube, or the one whose coordinates have the "
                                  "smallest hash",
                       .choices = {"center", "hash"}}},
          .make = make_voxel,
          .formula =
              "Voxel of p: (⌊x / size⌋, ⌊y / size⌋, ⌊z / size⌋), quotients rounded to float64: a point on a\n"
              "face belongs to the voxel above it. The grid does not depend on the cloud.\n"
              "keep=center: the least |p - c|², ((dx² + dy²) + dz²) in float64, c = (voxel + 0.5) * size.\n"
              "keep=hash: the least hash of decimate, with the seed 0x766f78656c.\n"
              "Of equal ones the point of the least x, then y, then z, then input row.",
          .undefined = "Points without a finite place all stay.",
          .cost = "a pass that puts the points in order by voxel, without a search; memory does not depend on the size",
          .example = "knn(k=12) | voxel(0.5) | normals"};
}

Voxel::Voxel(double size, VoxelKeep keep) : size_(size), keep_(keep) {
  if (!(size > 0 && std::isfinite(size)))
    fail_usage("voxel: the size {} is not a positive length; give one in the length unit of the cloud.", size);
}

Contract Voxel::contract() const {
  return {.makes = {selection_attribute()}, .alone = true, .selects = Selects::in_order, .has_places = true};
}

Options Voxel::own_options() const {
  return {{"size", size_}, {"keep", std::string(keep_ == VoxelKeep::hash ? "hash" : "center")}};
}

std::unique_ptr<Thinning> Voxel::thinning(const ThinningSetup&) const {
  return std::make_unique<OneOfEachVoxel>(size_, keep_);
}

Vec3 Voxel::place_of(Vec3 position) const {
  constexpr double kMost = std::numeric_limits<double>::max();
  const auto number = [&](double c) { return std::clamp(std::floor(c / size_), -kMost, kMost); };
  return {number(position.x), number(position.y), number(position.z)};
}

}  // namespace pointsweep
