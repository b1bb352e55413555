// SPDX-License-Identifier: MIT
/// Keeping the first points of the inputs.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/points/input_row.h"

namespace pointsweep {
namespace {

const OptionTable<HeadOptions>& head_options() {
  static const OptionTable<HeadOptions> table = {
      option("number", &HeadOptions::number, "keep the points of so many rows, or all points of a cloud that has fewer",
             {.least = 1, .required = true, .positional = true, .sample = std::uint64_t{1000}})};
  return table;
}

/// Keeps the points whose rows are below HeadOptions::number. Rows are numbered over all inputs, like `row` in
/// conditions, independently of rows that earlier stages have dropped.
class Head final : public SelectOperator {
 public:
  /// Throws UsageError for a number of 0.
  explicit Head(const HeadOptions& options) : options_(options) { head_options().declare(*this, options); }
  std::string name() const override { return "head"; }
  std::vector<Attribute> reads() const override { return {scalar(kInputRow, Type::u64, "", "")}; }
  void keep(const Neighborhoods& points, std::span<std::uint8_t> kept) const override {
    const std::uint64_t* const rows = points.values<std::uint64_t>(0);
    for (std::size_t i = 0; i < points.size(); ++i) kept[i] = rows[i] < options_.number;
  }

 private:
  HeadOptions options_;
};

}  // namespace

OperatorDeclaration head_declaration() {
  return {
      .name = "head",
      .meaning = "keeps the first points of the inputs, in the order of the files and their rows",
      .options = head_options().declarations(),
      .make = head_options().maker<Head>(),
      .formula =
          "Point i is kept if its row in the inputs is less than number, as by where(row < number): rows count from "
          "0 over all inputs, whatever earlier stages have left out.",
      .undefined = "Points without a finite place count and stay like all others, unless the run drops them.",
      .cost = "a pass over the rows, without a search",
      .example = "head(1000)"};
}

ChainStage operators::head(const HeadOptions& options) { return std::make_shared<Head>(options); }

}  // namespace pointsweep
