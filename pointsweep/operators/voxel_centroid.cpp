// SPDX-License-Identifier: MIT
#include "pointsweep/operators/voxel_centroid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include "pointsweep/math/exact_sum.h"
#include "pointsweep/operators/voxel.h"
#include "pointsweep/operators/voxel_candidate.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

constexpr const char* kVoxelMeans = "voxel_means";
constexpr std::size_t kBesidesMeans = 4;  ///< 1, x, y and z
/// Whole numbers that are measured; all others are labels or counts.
constexpr std::string_view kMeasured[] = {"intensity", "red", "green", "blue", "nir", "alpha"};

bool is_floating(Type type) { return type == Type::f32 || type == Type::f64; }

std::size_t means_of(const std::vector<AveragedAttribute>& averaged) {
  std::size_t n = 0;
  for (const AveragedAttribute& a : averaged) n += a.made.fields.size();
  return n;
}

Attribute voxel_means(std::size_t means) {
  Attribute a{kVoxelMeans, Type::f64, Kind::scalar, {}, "1", "means of a voxel"};
  for (std::size_t i = 0; i < kBesidesMeans + means; ++i) a.fields.push_back(fmt::format("{}_{}", kVoxelMeans, i));
  return a;
}

/// Sums of the voxel whose points come now.
class MeansOfVoxels final : public OrderedWork {
 public:
  MeansOfVoxels(double size, std::size_t means) : size_(size), means_(means), terms_(3 + means) {}
  unsigned rounds() const override { return 1; }

  void add(unsigned, const OrderedPoints& points, MadeInOrder& made) override {
    for (std::size_t i = 0; i < points.rows.size(); ++i) {
      if (!any_ || !(points.places[i] == voxel_)) {
        finish_voxel(made);
        voxel_ = points.places[i];
      }
      take(points.positions[i], points.rows[i], points.values.data() + i * means_);
    }
  }
  void end(unsigned, MadeInOrder& made) override { finish_voxel(made); }

 private:
  /// Of the values that are finite.
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
    /// The quotient of two rounded numbers may be off the values by a bit.
    double mean() const {
      if (count == 0) return std::numeric_limits<double>::quiet_NaN();
      return std::clamp(sum.rounded() / static_cast<double>(count), least, most);
    }
  };

  void take(Vec3 p, std::uint64_t row, const double* values) {
    const VoxelCandidate next = nearest_to_center(voxel_, size_, p, row);
    if (!any_ || next < best_) best_ = next;
    any_ = true;
    for (int a = 0; a < 3; ++a) terms_[static_cast<std::size_t>(a)].add(p[a]);
    for (std::size_t m = 0; m < means_; ++m) terms_[3 + m].add(values[m]);
  }

  void finish_voxel(MadeInOrder& made) {
    if (!any_) return;
    std::vector<double> values = {1};
    for (const Term& term : terms_) values.push_back(term.mean());
    made.rows.push_back(best_.row);
    const auto* bytes = reinterpret_cast<const std::byte*>(values.data());
    made.values.insert(made.values.end(), bytes, bytes + values.size() * sizeof(double));
    terms_.assign(3 + means_, Term());
    any_ = false;
  }

  double size_;
  std::size_t means_;
  std::vector<Term> terms_;
  VoxelCandidate best_;
  Vec3 voxel_;
  bool any_ = false;
};

/// Unit vectors; 0 where the mean is 0, or not a number.
void make_directions(double* v) {
  const double most = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
  const bool none = !(most > 0) || !std::isfinite(v[0] + v[1] + v[2]);
  const Vec3 scaled = none ? Vec3{} : Vec3{v[0] / most, v[1] / most, v[2] / most};
  const double size = none ? 1 : length(scaled);
  for (int a = 0; a < 3; ++a) v[a] = scaled[a] / size;
}

/// The components of the attributes `reads` of point i, the first of which is read `first` of the stage.
void copy_own(const Neighborhoods& in, std::size_t i, std::size_t first, const std::vector<Attribute>& reads,
              std::vector<double>& values) {
  std::size_t next = 0;
  for (std::size_t r = 0; r < reads.size(); ++r) {
    const Field field{.name = "", .type = reads[r].type};
    const std::byte* value = in.values<std::byte>(first + r) + i * reads[r].bytes();
    for (std::uint32_t c = 0; c < reads[r].fields.size(); ++c) values[next++] = value_of(field, value, c);
  }
}

}  // namespace

std::vector<AveragedAttribute> averaged_attributes(const Schema& input, std::span<const Attribute> made) {
  std::vector<AveragedAttribute> averaged;
  std::set<std::size_t> taken;  // fields of the input
  const auto number = [](const Field& field) { return scalar(field.name, Type::f64, "", ""); };
  for (const Attribute& a : made) {
    for (const std::string& field : a.fields)
      if (const auto at = input.find(field)) taken.insert(*at);
    if (a.name == kVoxelMeans || a.kind == Kind::position) continue;
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

Contract VoxelMeans::contract() const {
  Contract contract{.makes = {voxel_means(means_of(averaged_))},
                    .alone = true,
                    .has_places = true,
                    .arrival = "those of a voxel together"};
  for (const AveragedAttribute& a : averaged_)
    contract.reads.insert(contract.reads.end(), a.reads.begin(), a.reads.end());
  return contract;
}

std::shared_ptr<const Operator> VoxelMeans::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<VoxelMeans>(*this);
  bound->averaged_ = averaged_attributes(input, made);
  return bound;
}

Vec3 VoxelMeans::place_of(Vec3 position) const { return voxel_of_position(position, size_); }

std::unique_ptr<OrderedWork> VoxelMeans::work(const OrderedSetup&) const {
  return std::make_unique<MeansOfVoxels>(size_, means_of(averaged_));
}

Contract TakeVoxelMeans::contract() const {
  Contract contract{.reads = {voxel_means(means_of(averaged_))}, .makes = {position_attribute()}, .alone = true};
  for (const AveragedAttribute& a : averaged_) {
    contract.reads.insert(contract.reads.end(), a.reads.begin(), a.reads.end());
    contract.makes.push_back(a.made);
  }
  return contract;
}

std::shared_ptr<const Operator> TakeVoxelMeans::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<TakeVoxelMeans>(*this);
  bound->averaged_ = averaged_attributes(input, made);
  return bound;
}

/// A row without means keeps its values: it is left out, or its point has no finite place.
void TakeVoxelMeans::apply(const Neighborhoods& in, Columns& out) const {
  const std::size_t stride = kBesidesMeans + means_of(averaged_);
  const auto* const all = reinterpret_cast<const double*>(in.values<std::byte>(0));
  const auto position = out.column<std::array<double, 3>>(0);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const double* mean = all + i * stride;
    const Vec3 p = in.position(i);
    position[i] = mean[0] != 0 ? std::array{mean[1], mean[2], mean[3]} : std::array{p.x, p.y, p.z};
  }
  std::size_t first = kBesidesMeans, read = 1;
  for (std::size_t m = 0; m < averaged_.size(); ++m) {
    const AveragedAttribute& attribute = averaged_[m];
    const std::size_t width = attribute.made.fields.size();
    with_type(attribute.made.type, [&]<class T>() {
      T* to = reinterpret_cast<T*>(out.column<std::byte>(1 + m).data());
      std::vector<double> values(width);
      for (std::size_t i = 0; i < in.size(); ++i) {
        const double* mean = all + i * stride;
        if (mean[0] == 0) {
          copy_own(in, i, read, attribute.reads, values);
        } else {
          std::copy_n(mean + first, width, values.begin());
          if (attribute.is_direction) make_directions(values.data());
        }
        for (const double v : values) *to++ = static_cast<T>(std::is_floating_point_v<T> ? v : std::nearbyint(v));
      }
    });
    first += width;
    read += attribute.reads.size();
  }
}

Contract KeepVoxelMeans::contract() const {
  return {.reads = reads_, .makes = {selection_attribute()}, .alone = true, .selects = Selects::by_value};
}

std::shared_ptr<const Operator> KeepVoxelMeans::bound(const Schema&, std::span<const Attribute> made) const {
  auto bound = std::make_shared<KeepVoxelMeans>(*this);
  bound->reads_ = {*std::ranges::find(made, std::string(kVoxelMeans), &Attribute::name)};
  return bound;
}

void KeepVoxelMeans::apply(const Neighborhoods& in, Columns& out) const {
  const std::size_t stride = reads_.front().fields.size();
  const auto* const means = reinterpret_cast<const double*>(in.values<std::byte>(0));
  const auto kept = out.column<std::uint8_t>(0);
  for (std::size_t i = 0; i < in.size(); ++i) kept[i] = means[i * stride] != 0 || !is_finite(in.position(i));
}

}  // namespace pointsweep
