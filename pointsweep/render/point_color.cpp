// SPDX-License-Identifier: MIT
#include "pointsweep/render/point_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "pointsweep/colors/color_map.h"
#include "pointsweep/fail.h"
#include "pointsweep/math/quantile_rank.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

constexpr Rgb kPlain{214, 214, 214};
constexpr std::initializer_list<const char*> kColorFields = {"red", "green", "blue"};

std::uint8_t byte_of(double value) {
  if (!(value > 0)) return 0;
  return static_cast<std::uint8_t>(std::min(value, 255.0) + 0.5);
}

bool is_fraction(const Field& field) { return field.type == Type::f32 || field.type == Type::f64; }

}  // namespace

PointColor::PointColor(const Schema& schema, std::string_view what, std::string_view option)
    : schema_(schema), chosen_by_user_(!what.empty()), name_(in_lower_case(what)) {
  if (what.empty()) {
    if (take(Kind::rgb, kColorFields)) name_ = "rgb";
    return;
  }
  if (name_ == "plain") return;
  if (name_ == "rgb" && take(Kind::rgb, kColorFields)) return;
  if (name_ == "normal" && take(Kind::normal, {"nx", "ny", "nz"})) return;
  if (name_ == "classification" && take(Kind::classes, {"classification"})) return;
  if (name_ == "height") {
    kind_ = Kind::height;
    return;
  }
  if (name_ == "curvature") {
    for (const char* name : {"rms_curvature", "mean_curvature", "absolute_curvature", "k1", "surface_variation"})
      if (take_number(name)) return;
  } else if (take_number(what)) {
    return;
  }
  std::string there;
  for (const Field& field : schema.fields) there += (there.empty() ? "" : ", ") + field.name;
  fail_usage("{}: the input has nothing called '{}'; it has {}.", option, what, there);
}

bool PointColor::take(Kind kind, std::initializer_list<const char*> names) {
  std::size_t taken = 0;
  for (const char* name : names) {
    const auto field = schema_.find(name);
    if (!field) return false;
    fields_[taken++] = schema_.fields[*field];
  }
  kind_ = kind;
  return true;
}

bool PointColor::take_number(std::string_view name) {
  const auto field = field_meant(schema_, name);
  if (!field) return false;
  kind_ = Kind::number;
  fields_[0] = schema_.fields[*field];
  name_ = fields_[0].name;
  return true;
}

void PointColor::look_at(const std::byte* record) {
  if (kind_ == Kind::classes) seen_[class_of(record)] = true;
  if (kind_ != Kind::rgb) return;
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = value_of(fields_[i], record);
    if (!std::isfinite(value)) continue;
    channels_[i].least = std::min(channels_[i].least, value);
    channels_[i].most = std::max(channels_[i].most, value);
  }
}

bool PointColor::colors_vary() const {
  return std::any_of(channels_.begin(), channels_.end(), [](const Channel& c) { return c.most > c.least; });
}

void PointColor::choose_without_colors(bool flat) {
  const bool plain = !flat && schema_.find("nx");
  kind_ = plain ? Kind::plain : Kind::height;
  name_ = plain ? "plain" : "height";
}

void PointColor::settle(const Sample& sample, Up up, bool flat) {
  up_ = up;
  if (kind_ == Kind::rgb && !colors_vary()) {
    remark_ = fmt::format("all points have the same colour ({:g}, {:g}, {:g})", channels_[0].least, channels_[1].least,
                          channels_[2].least);
  }
  if (!chosen_by_user_ && (kind_ != Kind::rgb || !colors_vary())) choose_without_colors(flat);
  if (!is_number()) return;
  std::vector<double> numbers;
  for (std::size_t i = 0; i < sample.positions.size(); ++i)
    numbers.push_back(number(&sample.records[i * sample.stride], sample.positions[i]));
  std::tie(lo_, hi_) = robust_range(std::move(numbers));
}

double PointColor::scale() const {
  const double most = std::max({0.0, channels_[0].most, channels_[1].most, channels_[2].most});
  if (is_fraction(fields_[0]) && most <= 1) return 255;
  return most <= 255 ? 1 : 255 / std::max(most, 65535.0);
}

std::uint8_t PointColor::class_of(const std::byte* record) const { return byte_of(value_of(fields_[0], record)); }

std::vector<std::uint8_t> PointColor::classes() const {
  std::vector<std::uint8_t> codes;
  for (std::size_t code = 0; code < seen_.size(); ++code)
    if (seen_[code]) codes.push_back(static_cast<std::uint8_t>(code));
  return codes;
}

Rgb PointColor::operator()(const std::byte* record, Vec3 position) const {
  if (kind_ == Kind::plain) return kPlain;
  if (kind_ == Kind::classes) return color_of_las_class(class_of(record));
  if (is_number()) {
    const double value = number(record, position);
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
  const auto quantile = [&](std::uint32_t percent) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(quantile_rank(values.size(), percent));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const double lo = quantile(5);
  return {lo, quantile(95)};
}

}  // namespace pointsweep
