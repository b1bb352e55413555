// SPDX-License-Identifier: MIT
/// Dividing the points at random into parts, for training, validation and test.
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/math/mix.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {
namespace {

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
