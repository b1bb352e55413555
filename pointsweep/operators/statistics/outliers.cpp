// SPDX-License-Identifier: MIT
#include "pointsweep/operators/statistics/outliers.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/math/exact_sum.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/kinds/results.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {
namespace {

/// Sums d and d² over the finite values d. Counts the finite values, and the finite values other than 0.
class DistanceMoments final : public Accumulator {
 public:
  explicit DistanceMoments(OutlierRule rule) : rule_(rule) {}
  void add(const double* values, std::size_t points) override {
    for (std::size_t i = 0; i < points; ++i) {
      const double d = values[i];
      if (!std::isfinite(d)) continue;
      sum_.add(d);
      squares_.add_product(d, d);
      ++count_;
      if (d != 0) ++nonzero_;
    }
  }
  void merge(const Accumulator& other) override {
    const auto& moments = static_cast<const DistanceMoments&>(other);
    sum_.add(moments.sum_);
    squares_.add(moments.squares_);
    count_ += moments.count_;
    nonzero_ += moments.nonzero_;
  }
  std::vector<std::byte> save() const override {
    Encoder out;
    out.begin(kEncoding);
    for (const ExactSum* sum : {&sum_, &squares_}) encode(out, sum->state());
    out.put<std::uint64_t>(count_);
    out.put<std::uint64_t>(nonzero_);
    return out.take();
  }
  void load(std::span<const std::byte> bytes) override {
    Decoder in(bytes);
    in.begin(kEncoding);
    const ExactSum::State sum = decode(in), squares = decode(in);
    const auto count = in.get<std::uint64_t>(), nonzero = in.get<std::uint64_t>();
    in.finish();
    sum_.add(sum);
    squares_.add(squares);
    count_ += count;
    nonzero_ += nonzero;
  }
  std::vector<double> finish() const override {
    const auto n = static_cast<double>(count_);
    if (count_ == 0) return {std::numeric_limits<double>::quiet_NaN(), 0, 0};
    const double by = rule_.population ? n : n - 1;
    return {sum_.rounded() / n, by > 0 ? std::sqrt(n_squared_variance() / n / by) : 0, n};
  }

 private:
  static constexpr Encoding kEncoding{"moments", 1};

  static void encode(Encoder& out, const ExactSum::State& state) {
    out.put<std::uint32_t>(state.first);
    out.put_numbers<std::int64_t>(state.digits);
    for (const bool flag : {state.nan, state.positive_infinity, state.negative_infinity}) out.put_bool(flag);
  }
  static ExactSum::State decode(Decoder& in) {
    return {in.get<std::uint32_t>(), in.get_numbers<std::int64_t>(), in.get_bool(), in.get_bool(), in.get_bool()};
  }

  /// Returns n Σ (d - mean)². If values of 0 are excluded from the sum: n Σ d² - (2 - m/n) (Σ d)² with m values that
  /// are not 0.
  double n_squared_variance() const {
    const auto n = static_cast<double>(count_);
    const double zeros = rule_.zero_is_outlier ? static_cast<double>(count_ - nonzero_) : 0;
    const double all = pointsweep::n_squared_variance(sum_, squares_, n);
    if (zeros == 0) return all;
    // A value of 0 contributes n mean², which is subtracted here.
    const double mean = sum_.rounded() / n;
    return std::max(0.0, all - zeros * (n * (mean * mean)));
  }

  ExactSum sum_, squares_;
  std::uint64_t count_ = 0, nonzero_ = 0;
  OutlierRule rule_;
};

const OptionTable<SorOptions>& sor_options() {
  static const OptionTable<SorOptions> table = {
      option("multiplier", &SorOptions::multiplier,
             "a mean distance this many standard deviations above that of the cloud makes an outlier"),
      option("definition", &SorOptions::definition, "use the rule of this program; the formula shows the differences",
             {.choices = {"pointsweep", "pdal", "pcl", "open3d", "cloudcompare"}})};
  return table;
}

OutlierRule rule_of(OutlierDefinition definition) {
  switch (definition) {
    case OutlierDefinition::pdal:
      return {.threshold_is_outlier = true};
    case OutlierDefinition::open3d:
      return {.counts_point = true, .zero_is_outlier = true, .threshold_is_outlier = true};
    case OutlierDefinition::cloudcompare:
      return {.population = true};
    case OutlierDefinition::pointsweep:
    case OutlierDefinition::pcl:
      break;
  }
  return {};
}

/// Makes mean_distance: Σ_j |p_j - p_i| / |N_i|, or, if the rule counts the point, / (|N_i| + 1), summed in double in
/// the order of the neighbours, at the positions the stage sees. Points without a mean distance count as degenerate.
class MeanDistance final : public LocalOperator {
 public:
  explicit MeanDistance(const SorOptions& options) : counts_point_(rule_of(options.definition).counts_point) {
    sor_options().declare(*this, options);
  }
  std::string name() const override { return "mean_distance"; }
  Contract contract() const override { return {{}, {}, {mean_distance_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<double> mean = out.column<double>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < in.count(i); ++j) sum += std::sqrt(in.distance2(i, j));
      const double distance = sum / (static_cast<double>(in.count(i)) + (counts_point_ ? 1 : 0));
      const bool none = in.count(i) == 0 || !std::isfinite(distance);
      mean[i] = none ? std::numeric_limits<double>::quiet_NaN() : distance;
      if (none) out.mark_degenerate(i);
    }
  }

 private:
  bool counts_point_;
};

/// Makes outlier: 1 for points without a mean distance, and where mean_distance > mean + multiplier * deviation over
/// all points with a mean distance, or >= if the rule has `threshold_is_outlier`; 1 also where mean_distance is 0 if
/// the rule has `zero_is_outlier`; else 0.
class Outlier final : public LocalOperator {
 public:
  explicit Outlier(const SorOptions& options, double threshold = std::numeric_limits<double>::quiet_NaN())
      : options_(options), threshold_(threshold) {
    sor_options().declare(*this, options);
  }
  std::string name() const override { return "outlier"; }
  Contract contract() const override {
    Contract contract{.reads = {mean_distance_attribute()}, .makes = {outlier_attribute()}, .default_k = 0};
    contract.values = {std::make_shared<MeanAndDeviation>(mean_distance_attribute(), rule_of(options_.definition))};
    return contract;
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const OutlierRule rule = rule_of(options_.definition);
    const std::span<std::uint8_t> outlier = out.column<std::uint8_t>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const double d = in.value<double>(0, i);
      const bool within = rule.threshold_is_outlier ? d < threshold_ : d <= threshold_;
      outlier[i] = !within || (rule.zero_is_outlier && d == 0);
    }
  }
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const override {
    return std::make_shared<Outlier>(options_, values[0][0] + options_.multiplier * values[0][1]);
  }

 private:
  SorOptions options_;
  double threshold_;  ///< mean + multiplier * deviation
};

/// `sor`: MeanDistance and Outlier, in order.
class StatisticalOutliers final : public CompositeOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit StatisticalOutliers(const SorOptions& options) : options_(options) { sor_options().declare(*this, options); }
  std::string name() const override { return "sor"; }
  Contract contract() const override { return {{}, {}, {mean_distance_attribute(), outlier_attribute()}}; }
  std::vector<ChainStage> parts() const override {
    return {std::make_shared<MeanDistance>(options_), std::make_shared<Outlier>(options_)};
  }

 private:
  SorOptions options_;
};

/// `denoise`: sor, a condition that drops outliers, and a drop of the attributes that sor makes.
class Denoise final : public CompositeOperator {
 public:
  explicit Denoise(const SorOptions& options) : options_(options) { sor_options().declare(*this, options); }
  std::string name() const override { return "denoise"; }
  Contract contract() const override { return {.makes = {selection_attribute()}}; }
  std::vector<ChainStage> parts() const override {
    return {std::make_shared<MeanDistance>(options_), std::make_shared<Outlier>(options_),
            operators::where("outlier == 0"), Drop{{mean_distance_attribute().name, outlier_attribute().name}}};
  }

 private:
  SorOptions options_;
};

}  // namespace

OperatorDeclaration sor_declaration() {
  return {.name = "sor",
          .meaning =
              "statistical outliers: points whose mean distance to their neighbours exceeds mean + multiplier * "
              "deviation of the cloud",
          .options = sor_options().declarations(),
          .make = sor_options().maker<StatisticalOutliers>(),
          .formula =
              "d_i = 1/|N_i| Σ_j |p_j - p_i| (mean_distance); m and s: mean and standard deviation of "
              "all n finite d; t = m + multiplier * s. N_i never holds p_i.\n"
              "pointsweep:   s divides by n - 1; outlier: d > t\n"
              "pdal:         s divides by n - 1; outlier: d >= t. mean_k is our k\n"
              "pcl:          as pointsweep. mean_k is our k (before PCL 1.7: k + 1)\n"
              "open3d:       d_i = 1/(|N_i| + 1) Σ_j |p_j - p_i|, for the point itself counts, at "
              "distance 0. Terms of s with d = 0 are left out, but count in n; "
              "s divides by n - 1; outlier: d >= t or d = 0. nb_neighbors is k + 1\n"
              "cloudcompare: s divides by n; outlier: d > t. Its number of points is k + 1",
          .source =
              "Rusu, Semantic 3D object maps (2009); the sources of PDAL 2 (filters.outlier), PCL 1.13 "
              "(StatisticalOutlierRemoval), Open3D 0.18 (RemoveStatisticalOutliers) and CloudCompare 2.11 (sorFilter). "
              "PCL and CloudCompare round d to float32; here it is float64",
          .undefined = "Without neighbours, or if one has no finite place: mean_distance is NaN and outlier 1.",
          .degenerate = "have no neighbours with a place; their mean_distance is NaN and outlier is 1",
          .cost =
              "one more pass over the rows, in which the outliers are marked; it is the writing of the output "
              "where no later stage needs neighbours",
          .attributes = {{.name = "mean_distance",
                          .meaning = "mean distance to the neighbours at the positions the stage sees; undefined: NaN"},
                         {.name = "outlier",
                          .meaning =
                              "1: mean_distance is above mean + multiplier * deviation of the cloud, or NaN; else 0"}},
          .example = "knn(k=8) | sor(multiplier=2) | where(outlier == 0)"};
}

OperatorDeclaration denoise_declaration() {
  return {.name = "denoise",
          .meaning = "leaves out statistical outliers: sor, without the attributes that it makes",
          .options = sor_options().declarations(),
          .make = sor_options().maker<Denoise>(),
          .formula = "sor | where(outlier == 0) | drop(mean_distance, outlier)",
          .source = "that of sor",
          .undefined =
              "Without neighbours, or if one has no finite place, a point is left out. Attributes mean_distance and "
              "outlier of the input are refused.",
          .cost = "that of sor",
          .example = "knn(k=8) | denoise(multiplier=2)"};
}

ChainStage operators::sor(const SorOptions& options) { return std::make_shared<StatisticalOutliers>(options); }
ChainStage operators::denoise(const SorOptions& options) { return std::make_shared<Denoise>(options); }

Attribute mean_distance_attribute() {
  return nan_scalar("mean_distance", "length", "mean distance to the neighbours; NaN without any");
}

Attribute outlier_attribute() {
  Attribute a = scalar("outlier", Type::u8, "1", "1: farther from its neighbours than mean + multiplier * deviation");
  a.fill = std::byte{1};
  return a;
}

std::string MeanAndDeviation::text() const {
  return (rule_.population ? "mean and deviation (n) of " : "mean and deviation of ") + of_.name +
         (rule_.zero_is_outlier ? " without squares of 0" : "");
}

std::unique_ptr<Accumulator> MeanAndDeviation::start() const { return std::make_unique<DistanceMoments>(rule_); }

}  // namespace pointsweep
