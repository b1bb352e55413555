// SPDX-License-Identifier: MIT
#include "pointsweep/render/point_color.h"

#include <algorithm>
#include <cmath>

#include "pointsweep/error.h"
#include "pointsweep/render/color_map.h"

namespace pointsweep {
namespace {

constexpr Rgb kPlain{214, 214, 214};
constexpr std::array<const char*, 3> kColors = {"red", "green", "blue"}, kNormals = {"nx", "ny", "nz"};

std::uint8_t byte_of(double value) {
  if (!(value > 0)) return 0;
  return static_cast<std::uint8_t>(std::min(value, 255.0) + 0.5);
}

bool is_fraction(const Field& field) { return field.type == Type::f32 || field.type == Type::f64; }

}  // namespace

PointColor::PointColor(const Schema& schema, std::string_view what, int up, std::string_view option) : name_(what) {
  const char* const axes[] = {"x", "y", "z"};
  if (what == "plain") return;
  if (what.empty()) {
    name_ = "rgb";
    if (take(schema, Kind::rgb, kColors)) return;
    name_ = "plain";
    if (schema.find("nx")) return;
    what = "height";
  }
  if (what == "rgb" && take(schema, Kind::rgb, kColors)) return;
  if (what == "normal" && take(schema, Kind::normal, kNormals)) return;
  if (what == "height" && take_number(schema, axes[up])) {
    name_ = "height";
    return;
  }
  if (what == "curvature") {
    for (const char* name : {"rms_curvature", "mean_curvature", "absolute_curvature", "k1", "surface_variation"})
      if (take_number(schema, name)) return;
  } else if (take_number(schema, what)) {
    return;
  }
  std::string there;
  for (const Field& field : schema.fields) there += (there.empty() ? "" : ", ") + field.name;
  fail_usage("{}: the input has nothing called '{}'; it has {}.", option, what, there);
}

bool PointColor::take(const Schema& schema, Kind kind, const std::array<const char*, 3>& names) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto field = schema.find(names[i]);
    if (!field) return false;
    fields_[i] = schema.fields[*field];
  }
  kind_ = kind;
  return true;
}

bool PointColor::take_number(const Schema& schema, std::string_view name) {
  const auto field = schema.find(name);
  if (!field) return false;
  kind_ = Kind::number;
  fields_[0] = schema.fields[*field];
  name_ = fields_[0].name;
  return true;
}

void PointColor::look_at(const std::byte* record) {
  if (kind_ != Kind::rgb) return;
  for (const Field& field : fields_) {
    const double value = value_of(field, record);
    if (std::isfinite(value)) most_ = std::max(most_, value);
  }
}

double PointColor::scale() const {
  if (is_fraction(fields_[0]) && most_ <= 1) return 255;
  return most_ <= 255 ? 1 : 255 / std::max(most_, 65535.0);
}

Rgb PointColor::operator()(const std::byte* record) const {
  if (kind_ == Kind::plain) return kPlain;
  if (kind_ == Kind::number) {
    const double value = number(record);
    return viridis(hi_ > lo_ ? (value - lo_) / (hi_ - lo_) : 0 * value);
  }
  std::array<double, 3> v{};
  for (std::size_t i = 0; i < 3; ++i) v[i] = value_of(fields_[i], record);
  if (kind_ == Kind::normal)
    return {byte_of(127.5 * (1 + v[0])), byte_of(127.5 * (1 + v[1])), byte_of(127.5 * (1 + v[2]))};
  const double s = scale();
  return {byte_of(s * v[0]), byte_of(s * v[1]), byte_of(s * v[2])};
}

std::pair<double, double> robust_range(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {0, 1};
  const auto quantile = [&](double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double lo = quantile(0.05);
  return {lo, quantile(0.95)};
}

}  // namespace pointsweep
