// SPDX-License-Identifier: MIT
#include "pointsweep/operators/graph/orient.h"

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

namespace pointsweep {
namespace {

const OptionTable<OrientOptions>& orient_options() {
  static const OptionTable<OrientOptions> table = {
      option("method", &OrientOptions::method,
             "find signs by the minimum spanning forest of the graph of neighbours (mst), or by the place of the "
             "sensor at the gps_time of the point (trajectory)",
             {.choices = {"mst", "trajectory"}}),
      option("viewpoint", &OrientOptions::viewpoint,
             "point that most normals of each component face, in the coordinates of the cloud",
             {.unit = "length", .sample = Vec3{0, 0, 1.7}}),
      option("trajectory", &OrientOptions::trajectory,
             "file with the path of the sensor as lines of time, x, y, z, in the coordinates of the cloud and the "
             "times of gps_time",
             {.kind = OptionKind::file, .sample = "flight.csv"}),
      option("checksum", &OrientOptions::checksum,
             "checksum of the trajectory, as a processing record holds it; a file with other content is refused",
             {.kind = OptionKind::word, .sample = "baf74575be7585e0"})};
  return table;
}

}  // namespace

OperatorDeclaration orient_declaration() {
  return {.name = "orient",
          .meaning = "gives the normals of each connected surface consistent signs, by a minimum spanning forest",
          .options = orient_options().declarations(),
          .make = orient_options().maker<OrientedNormals>(),
          .formula =
              "Edges join i and j if j is in N_i or i is in N_j, weight 1 - |n_i . n_j|; equal ones by the two "
              "points, each by x, y, z, row. Along an edge of the minimum spanning forest signs s agree with the "
              "sign of n_i . n_j, where 0 counts as +.\n"
              "The signs of a component are turned together so that the larger in absolute value of "
              "Σ s n_z and Σ s n . (p - c) / e is positive, of equal ones the first; c is its centroid and e the mean "
              "of the three edges of its bounding box: up for open surfaces, outwards for closed ones. n counts in "
              "steps of 2^-20, p in steps of 2^-32, summed exactly. With viewpoint v: Σ sign(s n . (v - p)). If that "
              "is 0, the normal of the highest point points up; if that is level, the one of the first point by x, "
              "y, z, row stays.\n"
              "trajectory: n . (s(t) - p) >= 0, s(t) on the straight line between the places before and after t.",
          .source =
              "Hoppe, DeRose, Duchamp, McDonald, Stuetzle, Surface reconstruction from unorganized points (SIGGRAPH "
              "1992), Section 3.3; there the highest point alone decides",
          .undefined =
              "Normals of 0 stay 0. Points without a finite place keep their normal, and with a trajectory also those "
              "without a time. Times more than 1 s outside of the trajectory end the run.",
          .cost = "a sweep that ends a pass; about 150 bytes a point in the temporary folder",
          .neighbor_ns = 20,
          .attributes = {{.name = "normal_turned", .meaning = "1: orient has turned the normal; else 0"}},
          .example = "knn(k=12) | normals | orient"};
}

ChainStage operators::orient(const OrientOptions& options) { return std::make_shared<OrientedNormals>(options); }

Attribute normal_turned_attribute() {
  return scalar("normal_turned", Type::u8, "1", "1: orient has turned the normal");
}

NormalSigns::NormalSigns(const OrientOptions& options) : votes_(options.viewpoint) {
  orient_options().declare(*this, options);
}

void NormalSigns::connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const {
  for (std::uint32_t i = 0; i < in.size(); ++i) {
    const auto normal = in.value<std::array<float, 3>>(0, i);
    std::memcpy(ballots + i * sizeof normal, &normal, sizeof normal);
    const Vec3 n = in.vector(0, i);
    const NeighborRef* neighbors = in.neighbors(i);
    for (std::size_t j = 0; j < in.count(i); ++j) {
      const double along = dot(n, in.vector_of(0, neighbors[j]));
      edges.push_back({i, neighbors[j], std::isnan(along) ? 1 : 1 - std::abs(along), along < 0});
    }
  }
}

void NormalSigns::put_values(const ComponentLabel& label, std::byte* values) const { *values = std::byte(label.flips); }

/// Computes 0 - n, which is never -0, instead of -n.
void TurnedNormals::apply(const Neighborhoods& in, Columns& out) const {
  const auto normals = out.column<std::array<float, 3>>(0);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const auto n = in.value<std::array<float, 3>>(0, i);
    const bool turned = in.value<std::uint8_t>(1, i) != 0;
    normals[i] = turned ? std::array{0.0f - n[0], 0.0f - n[1], 0.0f - n[2]} : n;
  }
}

OrientedNormals::OrientedNormals(OrientOptions options, const std::string& place) : options_(std::move(options)) {
  const bool facing = options_.method == OrientMethod::trajectory;
  if (facing && (options_.trajectory.empty() || options_.viewpoint))
    fail_usage("{}: method=trajectory needs trajectory=FILE and no viewpoint.", place);
  if (!facing && !(options_.trajectory.empty() && options_.checksum.empty()))
    fail_usage("{}: a trajectory needs method=trajectory.", place);
  if (facing) {
    facing_ = std::make_shared<FacingNormals>(options_.trajectory, options_.checksum);
    options_.checksum = facing_->checksum();
  }
  orient_options().declare(*this, options_);
}

Contract OrientedNormals::contract() const {
  if (facing_) return facing_->contract();
  return {.reads = {normal_attribute()}, .makes = {normal_turned_attribute(), normal_attribute()}, .default_k = 16};
}

std::vector<ChainStage> OrientedNormals::parts() const {
  if (facing_) return {facing_};
  return {std::make_shared<NormalSigns>(options_), std::make_shared<TurnedNormals>()};
}

}  // namespace pointsweep
