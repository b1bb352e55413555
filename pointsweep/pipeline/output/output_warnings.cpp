// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/output_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pointsweep/pipeline/plan/output_layout.h"

namespace pointsweep {
namespace {

/// Returns half the step from a positive float32 number to the next greater one. Rounding to float32 changes numbers
/// from 0 to `number` by at most the half step.
double half_step_at(double number) {
  const auto at = static_cast<float>(number);
  int exponent = 0;
  std::frexp(at, &exponent);
  return std::ldexp(1.0, exponent - std::numeric_limits<float>::digits - 1);
}

double farthest_from_zero(const Box& box) {
  double farthest = 0;
  for (int a = 0; a < 3; ++a) farthest = std::max({farthest, -box.lo[a], box.hi[a]});
  return farthest;
}

/// Returns the least power of ten that is not less than the longest side of the box.
double power_of_ten_over(const Box& box) {
  double longest = 0;
  for (int a = 0; a < 3; ++a) longest = std::max(longest, box.hi[a] - box.lo[a]);
  return std::pow(10.0, std::ceil(std::log10(longest)));
}

}  // namespace

void OutputWarnings::add(const std::vector<std::string>& warnings, const std::filesystem::path& output) {
  for (const std::string& warning : warnings) {
    const std::string name = output.string();
    const std::string what = warning.starts_with(name) ? warning.substr(name.size()) : warning;
    const auto [known, is_new] = warnings_.try_emplace(what, Warning{warning});
    if (!is_new) ++known->second.others;
  }
}

std::vector<std::string> OutputWarnings::sentences() const {
  std::vector<std::string> all;
  for (const auto& [what, warning] : warnings_)
    all.push_back(warning.others == 0 ? warning.first
                                      : fmt::format("{} (The same holds for {} more {}.)", warning.first,
                                                    warning.others, warning.others == 1 ? "output" : "outputs"));
  return all;
}

std::string complete_outputs_text(std::size_t complete, std::size_t all) {
  return complete == 0 ? "" : fmt::format(" {} of {} outputs are complete and stay.", complete, all);
}

FloatRounding::FloatRounding(const Schema& input, const std::vector<Attribute>& made, const Schema& output)
    : stride_(output.stride) {
  const PositionFields before = position_fields(input, "the input"), after = position_fields(output, "the output");
  const auto is_float = [](const Field& f) { return f.is_plain() && f.type == Type::f32; };
  const bool was_float = is_float(before.x) && is_float(before.y) && is_float(before.z) && !moves_points(made);
  if (!was_float && is_float(after.x)) narrowed_ = after;
}

void FloatRounding::see(std::span<const std::byte> records) {
  if (!narrowed_) return;
  for (std::size_t at = 0; at < records.size(); at += stride_) {
    const std::byte* const record = records.data() + at;
    const Vec3 p{value_of(narrowed_->x, record), value_of(narrowed_->y, record), value_of(narrowed_->z, record)};
    if (is_finite(p)) box_.include(p);
  }
}

std::string FloatRounding::sentence() const {
  if (!narrowed_ || box_.empty()) return "";
  const double farthest = farthest_from_zero(box_);
  if (farthest == 0) return "";
  const double most = half_step_at(farthest);
  std::string text = fmt::format("x, y and z are stored as float32, which rounds them by at most {:.2g}", most);
  const Vec3 margin{most, most, most};
  const Box unrounded{box_.lo - margin, box_.hi + margin};
  const double unit = power_of_ten_over(unrounded);
  Vec3 move;
  for (int a = 0; a < 3; ++a) move[a] = 0 - std::round(unrounded.center()[a] / unit) * unit;
  const Box moved{unrounded.lo + move, unrounded.hi + move};
  const double then = half_step_at(farthest_from_zero(moved));
  if (then * 16 <= most)
    text += fmt::format("; transform(translate=[{:.12g}, {:.12g}, {:.12g}]) before would round them by at most {:.2g}",
                        move.x, move.y, move.z, then);
  return text + ".";
}

}  // namespace pointsweep
