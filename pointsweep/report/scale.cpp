// SPDX-License-Identifier: MIT
#include "pointsweep/report/scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pointsweep {
namespace {

double nice_step(double span, int wanted) {
  const double rough = span / wanted, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= rough) return step * power;
  }
  return 10 * power;
}

}  // namespace

std::string short_number(double value) {
  const double size = std::abs(value);
  if (size >= 1e12 || (size > 0 && size < 1e-3)) return fmt::format("{:.3g}", value);
  for (const auto& [unit, letter] : {std::pair(1e9, 'G'), std::pair(1e6, 'M'), std::pair(1e3, 'k')}) {
    if (size >= unit) return fmt::format("{:.4g}{}", value / unit, letter);
  }
  return fmt::format("{:.4g}", value);
}

Scale::Scale(double lo, double hi, double begin, double end, bool logarithmic)
    : lo_(logarithmic ? std::log10(lo) : lo),
      hi_(logarithmic ? std::log10(hi) : hi),
      begin_(begin),
      end_(end),
      logarithmic_(logarithmic) {
  if (!(hi_ > lo_)) hi_ = lo_ + 1;
}

double Scale::place(double value) const {
  const double v = logarithmic_ ? std::log10(value) : value;
  return begin_ + (v - lo_) / (hi_ - lo_) * (end_ - begin_);
}

std::vector<Tick> Scale::ticks(int wanted) const {
  std::vector<Tick> ticks;
  const double slack = 1e-9 * (hi_ - lo_);
  if (!logarithmic_) {
    const double step = nice_step(hi_ - lo_, wanted);
    for (double i = std::ceil((lo_ - slack) / step) + 0.0; i * step <= hi_ + slack; ++i) {
      ticks.push_back({i * step, short_number(i * step)});
    }
    return ticks;
  }
  const bool few = hi_ - lo_ < 2.5;
  const double skip = std::max(1.0, std::ceil((hi_ - lo_) / wanted));
  for (double power = std::floor(lo_); power <= hi_ + slack; power += few ? 1 : skip) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * std::pow(10.0, power), place = std::log10(value);
      if ((few || factor == 1) && place >= lo_ - slack && place <= hi_ + slack)
        ticks.push_back({value, short_number(value)});
    }
  }
  return ticks;
}

}  // namespace pointsweep
