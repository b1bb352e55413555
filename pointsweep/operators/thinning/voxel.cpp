// SPDX-License-Identifier: MIT
/// Keeping one point in each cube of a grid, unchanged or with the means of the cube.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/math/exact_sum.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/with_type.h"

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

/// Seed of the hashes that VoxelKeep::hash compares.
constexpr std::uint64_t kVoxelSeed = 0x766f78656c;  // "voxel" in ASCII

/// A point that a voxel may keep. The least candidate of a voxel is kept.
struct VoxelCandidate {
  double distance2 = 0;  ///< squared distance to the centre; 0 if the hash decides
  std::uint64_t hash = 0;
  Vec3 position;
  std::uint64_t row = 0;

  bool operator<(const VoxelCandidate& other) const { return key() < other.key(); }

 private:
  std::tuple<double, std::uint64_t, double, double, double, std::uint64_t> key() const {
    return {distance2, hash, position.x, position.y, position.z, row};
  }
};

/// Returns a candidate that is ranked by its distance to the centre of its voxel.
VoxelCandidate nearest_to_center(Vec3 voxel, double size, Vec3 p, std::uint64_t row) {
  const Vec3 center{(voxel.x + 0.5) * size, (voxel.y + 0.5) * size, (voxel.z + 0.5) * size};
  return {distance2(p, center), 0, p, row};
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

/// An attribute that is averaged. Other attributes keep the value of the kept row.
struct AveragedAttribute {
  Attribute made;  ///< holds the mean, in the type and fields of the averaged attribute; normal_attribute()
                   ///< for normals of the input
  std::vector<Attribute> reads;  ///< the averaged attribute, or scalars of the input that are its fields
  bool is_direction = false;     ///< true if the mean is normalised to a unit vector
};

/// Attributes of whole numbers that are measurements; all others are labels or counts.
constexpr std::string_view kMeasured[] = {"intensity", "red", "green", "blue", "nir", "alpha"};

bool is_floating(Type type) { return type == Type::f32 || type == Type::f64; }

/// Returns the value of type T nearest to a mean, halves to even. A mean of the largest 64-bit integers may be rounded
/// to a float64 above their range.
template <class T>
T nearest_of_type(double mean) {
  if constexpr (std::is_floating_point_v<T>) {
    return static_cast<T>(mean);
  } else {
    const double whole = std::nearbyint(mean);
    const bool is_above = whole >= std::ldexp(1.0, std::numeric_limits<T>::digits);
    return is_above ? std::numeric_limits<T>::max() : static_cast<T>(whole);
  }
}

/// Normalises the vector `v`; sets `v` to 0 if its length is 0 or not finite.
void make_directions(double* v) {
  const double most = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  const bool none = !(most > 0) || !std::isfinite(v[0] + v[1] + v[2]);
  const Vec3 scaled = none ? Vec3{} : Vec3{v[0] / most, v[1] / most, v[2] / most};
  const double size = none ? 1 : length(scaled);
  for (int a = 0; a < 3; ++a) v[a] = scaled[a] / size;
}

template <class T>
void append(T value, std::vector<std::byte>& bytes) {
  const auto own = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), own.begin(), own.end());
}

/// Keeps the point nearest to the centre of each voxel, with the means of the voxel. Holds the sums of one voxel.
class MeansOfVoxels final : public InOrderWork {
 public:
  MeansOfVoxels(double size, std::vector<AveragedAttribute> averaged) : size_(size), averaged_(std::move(averaged)) {
    for (const AveragedAttribute& a : averaged_) read_ += a.made.fields.size();
    terms_.resize(3 + read_);
  }

  void add(unsigned, const OrderedPoints& points, Findings& findings) override {
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      if (!any_ || !(points.places[i] == voxel_)) {
        finish_voxel(findings);
        voxel_ = points.places[i];
      }
      take(points.positions[i], points.rows[i], points.values.data() + i * read_, findings);
    }
  }
  void end(unsigned, Findings& findings) override { finish_voxel(findings); }

 private:
  /// The sum, count and range of the finite values of one component in a voxel.
  struct Term {
    ExactSum sum;
    std::uint64_t count = 0;
    double least = std::numeric_limits<double>::infinity(), most = -std::numeric_limits<double>::infinity();

    void add(double v) {
      if (!std::isfinite(v)) return;
      sum.add(v);
      ++count;
      least = std::min(least, v), most = std::max(most, v);
    }
    /// Returns the mean. Clamps it, since the quotient of two rounded numbers may leave the range of the values.
    double mean() const {
      if (count == 0) return std::numeric_limits<double>::quiet_NaN();
      return std::clamp(sum.rounded() / static_cast<double>(count), least, most);
    }
  };

  void take(Vec3 p, std::uint64_t row, const double* values, Findings& findings) {
    const VoxelCandidate next = nearest_to_center(voxel_, size_, p, row);
    const bool is_best = !any_ || next < best_;
    if (any_) findings.dropped.push_back(is_best ? best_.row : row);
    if (is_best) best_ = next;
    any_ = true;
    for (int a = 0; a < 3; ++a) terms_[a].add(p[a]);
    for (std::size_t m = 0; m < read_; ++m) terms_[3 + m].add(values[m]);
  }

  void finish_voxel(Findings& findings) {
    if (!any_) return;
    findings.rows.push_back(best_.row);
    std::vector<double> means;
    for (const Term& term : terms_) means.push_back(term.mean());
    for (int a = 0; a < 3; ++a) append(means[a], findings.values);
    std::size_t next = 3;
    for (const AveragedAttribute& a : averaged_) {
      if (a.is_direction) make_directions(means.data() + next);
      with_type(a.made.type, [&]<class T>() {
        for (std::size_t c = 0; c < a.made.fields.size(); ++c, ++next)
          append(nearest_of_type<T>(means[next]), findings.values);
      });
    }
    terms_.assign(terms_.size(), Term());
    any_ = false;
  }

  double size_;
  std::vector<AveragedAttribute> averaged_;
  std::size_t read_ = 0;  ///< number of values of a point
  std::vector<Term> terms_;
  VoxelCandidate best_;
  Vec3 voxel_;
  bool any_ = false;
};

/// Returns the attributes to average. Of the made attributes: normals, colours, and scalars of floating-point types. Of
/// the fields of `input` that no earlier stage replaces: the three components of the normal, floating-point numbers,
/// and the whole numbers of kMeasured; but, except for the normal, no arrays, packed or scaled fields.
std::vector<AveragedAttribute> averaged_attributes(const Schema& input, std::span<const Attribute> made) {
  std::vector<AveragedAttribute> averaged;
  std::set<std::size_t> taken;  // fields of the input that are averaged already, or that an earlier stage replaces
  const auto number = [](const Field& field) { return scalar(field.name, Type::f64, "", ""); };
  for (const Attribute& a : made) {
    for (const std::string& field : a.fields)
      if (const auto at = input.find(field)) taken.insert(*at);
    if (a.kind == Kind::position) continue;
    const bool is_direction = a.kind == Kind::normal && a.fields.size() == 3;
    const bool is_number = is_floating(a.type) && (a.kind == Kind::scalar || a.kind == Kind::color);
    if (is_direction || is_number || a.kind == Kind::color) averaged.push_back({a, {a}, is_direction});
  }
  for (const char* axis : {"x", "y", "z"})
    if (const auto at = input.find(axis)) taken.insert(*at);
  const Attribute normal = normal_attribute();
  std::vector<std::size_t> components;
  for (const std::string& field : normal.fields)
    if (const auto at = input.find(field); at && !taken.contains(*at)) components.push_back(*at);
  if (components.size() == 3) {
    AveragedAttribute& directions = averaged.emplace_back(AveragedAttribute{normal, {}, true});
    for (const std::size_t f : components) directions.reads.push_back(number(input.fields[f])), taken.insert(f);
  }
  for (std::size_t f = 0; f < input.fields.size(); ++f) {
    const Field& field = input.fields[f];
    if (taken.contains(f) || field.count != 1 || !field.is_plain()) continue;
    const bool measured = std::ranges::find(kMeasured, library_name_of(field.name)) != std::end(kMeasured);
    if (is_floating(field.type) || measured)
      averaged.push_back({scalar(field.name, field.type, "1", "mean of the voxel"), {number(field)}});
  }
  return averaged;
}

/// Keeps one of the points of each voxel. Along each axis, voxel v holds the coordinates whose quotient by the size,
/// rounded to float64, lies in [v, v + 1): the grid depends on coordinates only, not on the cloud, and a point on a
/// face belongs to the voxel above it. Points without a finite place are all kept. The points are put in order by
/// voxel, so that memory holds the choice of one voxel at a time, for any size of voxels. With VoxelKeep::centroid the
/// kept point moves to the mean position, and the attributes of averaged_attributes() become means.
class Voxel final : public InOrderOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Voxel(const VoxelOptions& options) : options_(options) { voxel_options().declare(*this, options); }
  std::string name() const override { return "voxel"; }
  InOrderContract in_order_contract() const override {
    InOrderContract contract{.drops_rows = true, .places = Places::of_operator, .arrival = "those of a voxel together"};
    if (options_.keep != VoxelKeep::centroid) return contract;
    contract.makes = {position_attribute()};
    for (const AveragedAttribute& a : averaged_) {
      contract.reads.insert(contract.reads.end(), a.reads.begin(), a.reads.end());
      contract.makes.push_back(a.made);
    }
    return contract;
  }
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override {
    if (options_.keep != VoxelKeep::centroid) return nullptr;
    auto bound = std::make_shared<Voxel>(*this);
    bound->averaged_ = averaged_attributes(input, made);
    return bound;
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup&) const override {
    if (options_.keep == VoxelKeep::centroid) return std::make_unique<MeansOfVoxels>(options_.size, averaged_);
    return std::make_unique<OneOfEachVoxel>(options_.size, options_.keep);
  }
  /// Returns the numbers of the voxel along the axes.
  Vec3 place_of(Vec3 position) const override {
    constexpr double kMost = std::numeric_limits<double>::max();
    const auto number = [&](double c) { return std::clamp(std::floor(c / options_.size), -kMost, kMost); };
    return {number(position.x), number(position.y), number(position.z)};
  }
  std::optional<Reach> reach() const override { return Reach{}; }
  std::uint64_t least_bytes(const CloudEstimate&) const override {
    return options_.keep == VoxelKeep::centroid ? 1 << 20 : 0;
  }

 private:
  VoxelOptions options_;
  std::vector<AveragedAttribute> averaged_;
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

}  // namespace pointsweep
