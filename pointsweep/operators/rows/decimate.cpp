// SPDX-License-Identifier: MIT
#include "pointsweep/operators/rows/decimate.h"

#include <memory>

#include "pointsweep/fail.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/operators/declare/declaration.h"

namespace pointsweep {

OperatorDeclaration decimate_declaration() {
  return {
      .name = "decimate",
      .meaning = "keeps a share of the points, chosen by a hash of their coordinates",
      .options = {{.name = "share",
                   .kind = OptionKind::number,
                   .meaning = "keep about this fraction of the points",
                   .least = 0,
                   .most = 1,
                   .required = true,
                   .positional = true,
                   .sample = 0.1},
                  {.name = "seed",
                   .kind = OptionKind::whole,
                   .preset = std::uint64_t{0},
                   .meaning = "seed of the random choice: another seed keeps other points; with the same seed, a "
                              "smaller share is a part of a larger one"}},
      .make = [](const OptionValues& options,
                 const Facts&) { return std::make_shared<Decimate>(options.number("share"), options.whole("seed")); },
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

Decimate::Decimate(double share, std::uint64_t seed) : share_(share), seed_(seed) {
  if (!(share >= 0 && share <= 1)) fail_usage("decimate: the share {} is not between 0 and 1.", share);
}

void Decimate::keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points.position(i);
    const double fraction = 0x1p-53 * static_cast<double>(coordinate_hash(p, seed_) >> 11);
    kept[i] = fraction < share_ || !is_finite(p);
  }
}

}  // namespace pointsweep
