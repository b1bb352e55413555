// SPDX-License-Identifier: MIT
/// Keeping a number of points, chosen by a hash of their coordinates.
#include <algorithm>
#include <memory>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

namespace pointsweep {
namespace {

const OptionTable<SampleOptions>& sample_options() {
  static const OptionTable<SampleOptions> table = {
      option("number", &SampleOptions::number, "keep so many points, or all points of a cloud that has fewer",
             {.least = 1, .required = true, .positional = true, .sample = std::uint64_t{1000}}),
      option("rest", &SampleOptions::rest, "keep all other points instead", {.choices = {"no", "yes"}}),
      option("seed", &SampleOptions::seed,
             "seed of the random choice: another seed keeps other points; with the same seed, a smaller number is a "
             "part of a larger one")};
  return table;
}

/// Keeps the first `number` points and drops all others, or the reverse if `rest`.
class FirstInOrder final : public InOrderWork {
 public:
  FirstInOrder(std::uint64_t number, bool rest) : number_(number), rest_(rest) {}

  void add(unsigned, const OrderedPoints& points, Findings& findings) override {
    const std::size_t first = std::min<std::uint64_t>(number_ - before_, points.rows.size());
    const auto dropped = rest_ ? points.rows.first(first) : points.rows.subspan(first);
    findings.dropped.insert(findings.dropped.end(), dropped.begin(), dropped.end());
    before_ += first;
  }

 private:
  std::uint64_t number_, before_ = 0;
  bool rest_;
};

/// Keeps the points with the least fractions (coordinate_fraction()), equal fractions in the order of their rows; with
/// SampleOptions::rest, keeps all other points instead. The place of a point is its fraction, so that points come in
/// this order. Points without a finite place are all kept.
class Sample final : public InOrderOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Sample(const SampleOptions& options) : options_(options) { sample_options().declare(*this, options); }
  std::string name() const override { return "sample"; }
  InOrderContract in_order_contract() const override {
    return {.drops_rows = true, .places = Places::of_operator, .arrival = "by the hash of their coordinates"};
  }
  std::unique_ptr<InOrderWork> start(const InOrderSetup&) const override {
    return std::make_unique<FirstInOrder>(options_.number, options_.rest);
  }
  Vec3 place_of(Vec3 position) const override {
    const double fraction = coordinate_fraction(position, options_.seed);
    return {fraction, fraction, fraction};  // all equal, so that the order is the same along any axis
  }

 private:
  SampleOptions options_;
};

}  // namespace

OperatorDeclaration sample_declaration() {
  return {.name = "sample",
          .meaning = "keeps exactly so many points, chosen by a hash of their coordinates, or all but these",
          .options = sample_options().declarations(),
          .make = sample_options().maker<Sample>(),
          .formula =
              "The points of the least f_i = ⌊h_i / 2^11⌋ / 2^53, h_i the hash of decimate; equal ones in the order of "
              "their rows. rest=yes keeps all other points.",
          .undefined = "Points without a finite place all stay, in addition to the number.",
          .cost = "a pass that puts the points in order by their hash, without a search",
          .example = "sample(1000)"};
}

ChainStage operators::sample(const SampleOptions& options) { return std::make_shared<Sample>(options); }

}  // namespace pointsweep
