// SPDX-License-Identifier: MIT
/// Keeping a share of the points, chosen by a hash of their coordinates.
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/math/mix.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"

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

}  // namespace pointsweep
