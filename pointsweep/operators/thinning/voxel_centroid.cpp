// SPDX-License-Identifier: MIT
#include "pointsweep/operators/thinning/voxel_centroid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <type_traits>
#include <utility>

#include "pointsweep/math/exact_sum.h"
#include "pointsweep/operators/thinning/voxel.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

/// Attributes of whole numbers that are measurements; all others are labels or counts.
constexpr std::string_view kMeasured[] = {"intensity", "red", "green", "blue", "nir", "alpha"};

bool is_floating(Type type) { return type == Type::f32 || type == Type::f64; }

/// Returns the value of type T nearest to a mean, halves to even. The largest integers of 64 bits round to a float64
/// that is above their range.
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

/// Normalises `v`; sets it to 0 if it is 0 or not finite.
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
  /// The sum, count and range of the finite values.
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
    for (int a = 0; a < 3; ++a) terms_[static_cast<std::size_t>(a)].add(p[a]);
    for (std::size_t m = 0; m < read_; ++m) terms_[3 + m].add(values[m]);
  }

  void finish_voxel(Findings& findings) {
    if (!any_) return;
    findings.rows.push_back(best_.row);
    std::vector<double> means;
    for (const Term& term : terms_) means.push_back(term.mean());
    for (int a = 0; a < 3; ++a) append(means[static_cast<std::size_t>(a)], findings.values);
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

}  // namespace

std::vector<AveragedAttribute> averaged_attributes(const Schema& input, std::span<const Attribute> made) {
  std::vector<AveragedAttribute> averaged;
  std::set<std::size_t> taken;  // fields of the input that need no mean of their own
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

std::unique_ptr<InOrderWork> means_of_voxels(double size, const std::vector<AveragedAttribute>& averaged) {
  return std::make_unique<MeansOfVoxels>(size, averaged);
}

}  // namespace pointsweep
