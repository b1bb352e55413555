// SPDX-License-Identifier: MIT
/// Choices by a hash of the coordinates: `decimate` keeps a share of the points, `sample` a number of points, and
/// `parts` divides the points at random into parts, for training, validation and test.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {
namespace {

const OptionTable<DecimateOptions>& decimate_options() {
  static const OptionTable<DecimateOptions> table = {
      option("share", &DecimateOptions::share, "keep about this fraction of the points",
             {.most = 1, .required = true, .positional = true, .sample = 0.1}),
      option("seed", &DecimateOptions::seed,
             "seed of the random choice: another seed keeps other points; with the same seed, a smaller share is a "
             "part of a larger one")};
  return table;
}

/// Keeps a point if the hash of its coordinates, scaled to [0, 1), is below `share`. The choice does not depend on
/// other points: tiles give the same points as the merged cloud, in any order. Of points with equal coordinates, all or
/// none are kept. Points without a finite place are all kept.
class Decimate final : public SelectOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Decimate(const DecimateOptions& options) : options_(options) { decimate_options().declare(*this, options); }
  std::string name() const override { return "decimate"; }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = points.position(i);
      kept[i] = coordinate_fraction(p, options_.seed) < options_.share || !is_finite(p);
    }
  }

 private:
  DecimateOptions options_;
};

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

/// Keeps SampleOptions::number points, those with the least fractions (coordinate_fraction()), equal fractions in the
/// order of their rows; with SampleOptions::rest, keeps all other points instead. The place of a point is its fraction,
/// so that points come in this order. Points without a finite place are all kept, and not counted.
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

/// A number that is added to the seed. Without it, a sample or decimate with the same seed would take all its points
/// from few parts.
constexpr std::uint64_t kPartsSeed = 0x7061727473;  // "parts" in ASCII

const OptionTable<PartsOptions>& parts_options() {
  static const OptionTable<PartsOptions> table = {
      option("number", &PartsOptions::number, "number of parts, of about the same size",
             {.least = 1, .most = 65536, .required = true, .positional = true, .sample = std::uint64_t{10}}),
      option("seed", &PartsOptions::seed, "seed of the random choice: another seed makes other parts")};
  return table;
}

/// Makes part, N u16: ⌊h n / 2^64⌋ with the hash h of the coordinates and n parts. Points of equal coordinates are in
/// the same part; points without a finite place are in part 0.
class Parts final : public LocalOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Parts(const PartsOptions& options) : options_(options) { parts_options().declare(*this, options); }
  std::string name() const override { return "parts"; }
  Contract contract() const override {
    return {.makes = {scalar("part", Type::u16, "1", "number of the part, from 0")}, .default_k = 0};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<std::uint16_t> part = out.column<std::uint16_t>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Vec3 p = in.position(i);
      const WholeNumber hash = coordinate_hash(p, options_.seed + kPartsSeed);
      part[i] = is_finite(p) ? static_cast<std::uint16_t>(hash * WholeNumber{options_.number} >> 64) : 0;
    }
  }

 private:
  PartsOptions options_;
};

}  // namespace

OperatorDeclaration decimate_declaration() {
  return {
      .name = "decimate",
      .meaning = "keeps a share of the points, chosen by a hash of their coordinates",
      .options = decimate_options().declarations(),
      .make = decimate_options().maker<Decimate>(),
      .formula =
          "Point i is kept if ⌊h_i / 2^11⌋ / 2^53 < share.\n"
          "h = m(m(m(seed ^ x) ^ y) ^ z) of the 64 bits of each coordinate as float64, 0 for -0;\n"
          "m(i): j = i + 0x9e3779b97f4a7c15; j = (j ^ j >> 30) * 0xbf58476d1ce4e5b9;\n"
          "j = (j ^ j >> 27) * 0x94d049bb133111eb; j ^ j >> 31, all modulo 2^64.",
      .source = "The function m: Steele, Lea and Flood, Fast splittable pseudorandom number generators (OOPSLA 2014).",
      .undefined = "Points of equal coordinates stay together or go together. Points without a finite place stay.",
      .cost = "a pass over the rows, without a search",
      .example = "decimate(0.1)"};
}

ChainStage operators::decimate(const DecimateOptions& options) { return std::make_shared<Decimate>(options); }

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

OperatorDeclaration parts_declaration() {
  return {.name = "parts",
          .meaning = "divides the points at random into parts, by a hash of their coordinates",
          .options = parts_options().declarations(),
          .make = parts_options().maker<Parts>(),
          .formula =
              "part_i = ⌊h_i number / 2^64⌋, h_i the hash of decimate, whose seed is increased by 0x7061727473, "
              "\"parts\" in ASCII.",
          .undefined = "Points of equal coordinates are in the same part. Points without a finite place are in part 0.",
          .cost = "a pass over the rows, without a search; none where other stages search anyway",
          .attributes = {{.name = "part", .meaning = "number of the part, from 0; undefined: 0"}},
          .example = "parts(10) | where(part < 8)"};
}

ChainStage operators::parts(const PartsOptions& options) { return std::make_shared<Parts>(options); }

}  // namespace pointsweep
