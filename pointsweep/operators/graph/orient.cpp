// SPDX-License-Identifier: MIT
/// Consistent signs of normals over a whole surface (H. Hoppe, T. DeRose, T. Duchamp, J. McDonald, W. Stuetzle,
/// "Surface reconstruction from unorganized points", SIGGRAPH 1992, Section 3.3), or signs by a trajectory
/// (facing_normals.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/connect/forest_log.h"
#include "pointsweep/fail.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/kinds/connect_operator.h"
#include "pointsweep/operators/surface/facing_normals.h"
#include "pointsweep/operators/surface/normals.h"

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

using Whole = __int128;

constexpr double kNormalUnits = 1 << 20, kPlaceUnits = 4294967296.0, kFarthest = 1099511627776.0;

/// Sums over points with signs s, normals n and positions p, in the steps of OrientationVotes: `normal` in units of
/// 2^-20, `place` of 2^-32, `out` of 2^-52. v: the viewpoint. The members from `normal` to `first_sign` change their
/// sign if all s change their sign.
struct Votes {
  std::array<Whole, 3> normal;  ///< Σ s n
  Whole out;                    ///< Σ s n · p
  std::int64_t facing;          ///< Σ sign(s n · (v - p))
  std::int64_t highest_sign;    ///< sign of s n_z of the highest point
  std::int64_t first_sign;      ///< s of the first point

  std::array<Whole, 3> place;  ///< Σ p
  std::int64_t points;
  Box box;
  PointKey highest, first;
};

Votes votes_at(const std::byte* bytes) {
  Votes votes;
  std::memcpy(&votes, bytes, sizeof votes);
  return votes;
}

std::int64_t sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

bool is_higher(const PointKey& a, const PointKey& b) {
  return a.position.z != b.position.z ? a.position.z > b.position.z : a < b;
}

std::array<Whole, 3> whole_place(Vec3 p) {
  std::array<Whole, 3> place;
  for (int a = 0; a < 3; ++a)
    place[a] = static_cast<Whole>(std::nearbyint(std::clamp(p[a], -kFarthest, kFarthest) * kPlaceUnits));
  return place;
}

/// Returns the sum `out` as the comment of OrientationVotes defines it, in units of 2^-20; 0 if the points have no
/// extent.
long double outwards(const Votes& v) {
  const Vec3 extent = v.box.extent();
  const long double mean = (static_cast<long double>(extent.x) + extent.y + extent.z) / 3;
  if (mean == 0) return 0;
  long double out = static_cast<long double>(v.out);
  for (int a = 0; a < 3; ++a)
    out -= static_cast<long double>(v.place[a]) / static_cast<long double>(v.points) *
           static_cast<long double>(v.normal[a]);
  return out / (kPlaceUnits * mean);
}

/// Decides the signs of a component by votes of all its points, so that the noise of a single normal does not decide.
/// Normals n count in steps of 2^-20, and positions p, limited to 2^40 in magnitude, in steps of 2^-32, so that sums
/// over the points are exact integers. With signs s and the centroid c of the component:
///   up  = Σ s n_z
///   out = Σ s n · (p - c) / e, e the mean edge of the component's bounding box: positive if normals point out of a
///   closed surface
/// The sum with the larger absolute value, `up` if both are equal, must be positive; else all signs are turned. With a
/// viewpoint v, the sum is Σ sign(s n · (v - p)) instead. If the sum is 0, the normal of the highest point must point
/// up (Hoppe et al. 1992); if that normal is horizontal, the first point keeps its normal.
class OrientationVotes final : public VoteRule {
 public:
  explicit OrientationVotes(std::optional<Vec3> viewpoint) : viewpoint_(viewpoint) {}
  /// A ballot is a normal, three float32.
  std::size_t ballot_bytes() const override { return 3 * sizeof(float); }
  std::size_t bytes() const override { return sizeof(Votes); }
  void start(std::byte* bytes, const PointKey& point, const std::byte* ballot) const override {
    std::array<float, 3> n;
    std::memcpy(n.data(), ballot, sizeof n);
    const Vec3 normal{n[0], n[1], n[2]};
    Votes v{};
    v.place = whole_place(point.position);
    for (int a = 0; a < 3; ++a) {
      if (is_finite(normal)) v.normal[a] = std::llrint(std::clamp(normal[a], -1.0, 1.0) * kNormalUnits);
      v.out += v.normal[a] * v.place[a];
    }
    if (viewpoint_) v.facing = sign_of(dot(normal, *viewpoint_ - point.position));
    v.highest_sign = sign_of(normal.z);
    v.first_sign = 1;
    v.points = 1;
    v.box = {point.position, point.position};
    v.highest = v.first = point;
    std::memcpy(bytes, &v, sizeof v);
  }
  void merge(std::byte* into, const std::byte* from, bool flips) const override {
    Votes v = votes_at(into);
    const Votes w = votes_at(from);
    const int sign = flips ? -1 : 1;
    for (int a = 0; a < 3; ++a) {
      v.normal[a] += sign * w.normal[a];
      v.place[a] += w.place[a];
    }
    v.out += sign * w.out;
    v.facing += sign * w.facing;
    v.points += w.points;
    v.box.include(w.box);
    if (is_higher(w.highest, v.highest)) v.highest = w.highest, v.highest_sign = sign * w.highest_sign;
    if (w.first < v.first) v.first = w.first, v.first_sign = sign * w.first_sign;
    std::memcpy(into, &v, sizeof v);
  }
  /// Returns the size of the result: one byte, not 0 if the signs must be flipped.
  std::size_t result_bytes() const override { return 1; }
  void conclude(const std::byte* votes, std::byte* result) const override {
    const Votes v = votes_at(votes);
    const long double up = static_cast<long double>(v.normal[2]), out = outwards(v);
    const long double vote = viewpoint_ ? v.facing : std::abs(up) >= std::abs(out) ? up : out;
    const bool turned = vote != 0 ? vote < 0 : v.highest_sign != 0 ? v.highest_sign < 0 : v.first_sign < 0;
    *result = std::byte(turned);
  }
  bool turns(const std::byte* result) const override { return *result != std::byte{0}; }

 private:
  std::optional<Vec3> viewpoint_;
};

/// Returns normal_turned, one uint8 per point: 1 if the operator orient has negated the normal.
Attribute normal_turned_attribute() {
  return scalar("normal_turned", Type::u8, "1", "1: orient has turned the normal");
}

/// Makes normal_turned: the signs along the minimum spanning forest of the graph of neighbours. An edge has the weight
/// 1 - |n_i . n_j|, or 1 if that is NaN. Its two points should have equal signs unless n_i . n_j < 0. OrientationVotes
/// decides which components to turn.
class NormalSigns final : public ConnectOperator {
 public:
  explicit NormalSigns(const OrientOptions& options) : votes_(options.viewpoint) {
    orient_options().declare(*this, options);
  }
  std::string name() const override { return "normal_signs"; }
  Contract contract() const override {
    return {{normal_attribute()}, {normal_attribute()}, {normal_turned_attribute()}};
  }
  bool weighted() const override { return true; }
  const VoteRule* votes() const override { return &votes_; }
  void connect(const Neighborhoods& in, std::vector<NeighborEdge>& edges, std::byte* ballots) const override {
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
  void put_values(const ComponentLabel& label, std::byte* values) const override { *values = std::byte(label.flips); }

 private:
  OrientationVotes votes_;
};

/// Makes `normal`: the existing normal, negated if `normal_turned` is 1.
class TurnedNormals final : public LocalOperator {
 public:
  std::string name() const override { return "turned_normals"; }
  Contract contract() const override {
    return {.reads = {normal_attribute(), normal_turned_attribute()}, .makes = {normal_attribute()}, .default_k = 0};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const auto normals = out.column<std::array<float, 3>>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const auto n = in.value<std::array<float, 3>>(0, i);
      normals[i] = in.value<std::uint8_t>(1, i) != 0 ? flipped(n) : n;
    }
  }
};

/// `orient`: NormalSigns, then TurnedNormals; or FacingNormals if the method is `trajectory`.
class OrientedNormals final : public CompositeOperator {
 public:
  /// Reads the trajectory, if the method needs one. Throws UsageError for options out of range or in conflict, and the
  /// errors of FacingNormals for the file. Messages about a conflict begin with `place`.
  explicit OrientedNormals(OrientOptions options, const std::string& place = "orient") : options_(std::move(options)) {
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
  std::string name() const override { return "orient"; }
  Contract contract() const override {
    if (facing_) return facing_->contract();
    return {.reads = {normal_attribute()}, .makes = {normal_turned_attribute(), normal_attribute()}, .default_k = 16};
  }
  std::vector<ChainStage> parts() const override {
    if (facing_) return {facing_};
    return {std::make_shared<NormalSigns>(options_), std::make_shared<TurnedNormals>()};
  }

 private:
  OrientOptions options_;  ///< options, with the checksum of the trajectory that was read
  std::shared_ptr<const FacingNormals> facing_;
};

}  // namespace

OperatorDeclaration orient_declaration() {
  return {
      .name = "orient",
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
      .attributes = {{.name = "normal_turned",
                      .meaning = "1: orient has turned the normal, or those around a point whose normal is 0; else 0"}},
      .example = "knn(k=12) | normals | orient"};
}

ChainStage operators::orient(const OrientOptions& options) { return std::make_shared<OrientedNormals>(options); }

}  // namespace pointsweep
