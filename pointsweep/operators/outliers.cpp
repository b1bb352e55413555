// SPDX-License-Identifier: MIT
#include "pointsweep/operators/outliers.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "pointsweep/fail.h"
#include "pointsweep/math/exact_sum.h"
#include "pointsweep/operators/declaration.h"

namespace pointsweep {
namespace {

/// Σ d, Σ d² and n of finite values.
class DistanceMoments final : public Accumulator {
 public:
  void add(const double* values, std::size_t points) override {
    for (std::size_t i = 0; i < points; ++i) {
      const double d = values[i];
      if (!std::isfinite(d)) continue;
      sum_.add(d);
      squares_.add_product(d, d);
      ++count_;
    }
  }
  void merge(const Accumulator& other) override {
    const auto& moments = static_cast<const DistanceMoments&>(other);
    sum_.add(moments.sum_);
    squares_.add(moments.squares_);
    count_ += moments.count_;
  }
  std::vector<double> finish() const override {
    const auto n = static_cast<double>(count_);
    if (count_ == 0) return {std::numeric_limits<double>::quiet_NaN(), 0, 0};
    const double deviation = count_ == 1 ? 0 : std::sqrt(n_squared_variance() / n / (n - 1));
    return {sum_.rounded() / n, deviation, n};
  }

 private:
  /// n Σ d² - (Σ d)², from 159 bits of both sums: close values far from 0 leave a small difference of large numbers.
  double n_squared_variance() const {
    const auto n = static_cast<double>(count_);
    ExactSum difference;
    for (const double part : squares_.expansion()) difference.add_product(n, part);
    const std::array<double, 3> sum = sum_.expansion();
    for (const double a : sum)
      for (const double b : sum) difference.add_product(-a, b);
    return std::max(0.0, difference.rounded());
  }

  ExactSum sum_, squares_;
  std::uint64_t count_ = 0;
};

}  // namespace

OperatorDeclaration sor_declaration() {
  return {.name = "sor",
          .meaning =
              "statistical outliers: points whose mean distance to their neighbours exceeds mean + multiplier * "
              "deviation of the cloud",
          .options = {{.name = "multiplier",
                       .kind = OptionKind::number,
                       .preset = 2.0,
                       .meaning = "standard deviations above the mean"}},
          .make = [](const OptionValues& options,
                     const Facts&) { return std::make_shared<StatisticalOutliers>(options.number("multiplier")); },
          .formula =
              "mean_distance = 1/|N_i| Σ_j |p_j - p_i|; outlier = 1 where mean_distance > m + multiplier * s, m and s\n"
              "the mean and the standard deviation (n - 1) of all finite mean_distance",
          .source = "Rusu, Semantic 3D object maps (2009); the definition of PCL",
          .undefined = "Without neighbours, or if one has no finite place: mean_distance is NaN and outlier 1.",
          .cost = "one more reading of the rows, or the writing of the output, in which the outliers are marked",
          .attributes = {{.name = "mean_distance",
                          .meaning = "mean distance to the neighbours at the positions the stage sees; undefined: NaN"},
                         {.name = "outlier",
                          .meaning =
                              "1: mean_distance is above mean + multiplier * deviation of the cloud, or NaN; else 0"}},
          .example = "knn(k=8) | sor(multiplier=2) | where(outlier == 0)"};
}

Attribute mean_distance_attribute() {
  Attribute a = scalar("mean_distance", Type::f64, "length", "mean distance to the neighbours; NaN without any");
  a.fill = std::byte{0xff};  // NaN
  return a;
}

Attribute outlier_attribute() {
  Attribute a = scalar("outlier", Type::u8, "1", "1: farther from its neighbours than mean + multiplier * deviation");
  a.fill = std::byte{1};
  return a;
}

void MeanDistance::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<double> mean = out.column<double>(0);
  for (std::size_t i = 0; i < in.size(); ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < in.count(i); ++j) sum += std::sqrt(in.distance2(i, j));
    const double distance = sum / static_cast<double>(in.count(i));
    const bool none = !std::isfinite(distance);
    mean[i] = none ? std::numeric_limits<double>::quiet_NaN() : distance;
    if (none) out.mark_degenerate(i);
  }
}

std::unique_ptr<Accumulator> MeanAndDeviation::start() const { return std::make_unique<DistanceMoments>(); }

Contract Outlier::contract() const {
  Contract contract{{mean_distance_attribute()}, {}, {outlier_attribute()}, true};
  contract.values = {std::make_shared<MeanAndDeviation>(mean_distance_attribute())};
  return contract;
}

void Outlier::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<std::uint8_t> outlier = out.column<std::uint8_t>(0);
  for (std::size_t i = 0; i < in.size(); ++i) outlier[i] = !(in.value<double>(0, i) <= threshold_);
}

std::shared_ptr<const Operator> Outlier::with_values(std::span<const std::vector<double>> values) const {
  return std::make_shared<Outlier>(multiplier_, values[0][0] + multiplier_ * values[0][1]);
}

StatisticalOutliers::StatisticalOutliers(double multiplier) : multiplier_(multiplier) {
  if (!(multiplier >= 0 && std::isfinite(multiplier)))
    fail_usage("sor: the multiplier {} is not a number of at least 0.", multiplier);
}

std::vector<std::shared_ptr<const Operator>> StatisticalOutliers::parts() const {
  return {std::make_shared<MeanDistance>(), std::make_shared<Outlier>(multiplier_)};
}

}  // namespace pointsweep
