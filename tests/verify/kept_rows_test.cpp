// SPDX-License-Identifier: MIT
/// The rows that a run keeps, which verify finds by formulas of its own, even if an operator is broken.
#include "pointsweep/verify/values/kept_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "pointsweep/points/input_row.h"
#include "pointsweep/verify/formulas/thinning.h"
#include "tests/pipeline/attribute_cloud.h"

namespace pointsweep {
namespace {

/// A `where` that keeps every row, whatever its condition says.
class BrokenWhere final : public SelectOperator {
 public:
  BrokenWhere(std::string condition, std::vector<Attribute> reads)
      : condition_(std::move(condition)), reads_(std::move(reads)) {}
  std::string name() const override { return "where"; }
  std::vector<Attribute> reads() const override { return reads_; }
  void keep(const Neighborhoods&, std::span<std::uint8_t> kept) const override { std::ranges::fill(kept, 1); }

 private:
  Options own_options() const override { return {{"condition", condition_}}; }

  std::string condition_;
  std::vector<Attribute> reads_;
};

std::uint64_t kept_of(const Records& cloud, const std::string& condition, std::vector<Attribute> reads = {}) {
  const auto where = std::make_shared<BrokenWhere>(condition, std::move(reads));
  return with_kept_rows(cloud.cloud(), {std::shared_ptr<const SelectOperator>(where)}, 1 << 20, {}).count();
}

/// An operator with the name and options of head(3) that keeps all rows.
class BrokenHead final : public SelectOperator {
 public:
  std::string name() const override { return "head"; }
  std::vector<Attribute> reads() const override { return {scalar(kInputRow, Type::u64, "", "")}; }
  void keep(const Neighborhoods&, std::span<std::uint8_t> kept) const override { std::ranges::fill(kept, 1); }

 private:
  Options own_options() const override { return {{"number", std::uint64_t{3}}}; }
};

Records cloud_of_levels() {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) points.push_back({0.1 * i, 0, double(i)});
  points.push_back({0, 0, std::numeric_limits<double>::quiet_NaN()});
  return with_attributes(points);
}

TEST(KeptRows, AConditionIsDecidedByItsFormulaAndNotByTheOperator) {
  EXPECT_EQ(kept_of(cloud_of_levels(), "z >= 10 && z < 15.5"), 6u);
  EXPECT_EQ(kept_of(cloud_of_levels(), "z >= 10 || z < 10"), 40u);
}

TEST(KeptRows, TheFirstRowsAreCountedByTheirFormulaAndNotByTheOperator) {
  const InputCloud numbered = cloud_of_levels().cloud().numbered(1);
  EXPECT_EQ(with_kept_rows(numbered, {std::make_shared<BrokenHead>()}, 1 << 20, {}).count(), 2u);
}

TEST(KeptRows, ConditionsOnWholeNumbersOf64BitsAreExact) {
  const std::vector<Attribute> id = {scalar("id", Type::u64, "1", "")};
  EXPECT_EQ(kept_of(cloud_of_levels(), "id == 9223372036854775809", id), 1u);  // 2^63 + 1
}

TEST(KeptRows, AMeanHalfwayBetweenWholeNumbersIsTheEvenOne) {
  const auto mean_of = [](std::initializer_list<double> values) {
    formulas::Mean mean;
    for (const double v : values) mean.add(v);
    return mean.whole();
  };
  EXPECT_FALSE(mean_of({1, 2}).is_open());
  EXPECT_EQ(mean_of({1, 2}).value.x, 2);
  EXPECT_FALSE(mean_of({2, 3}).is_open());
  EXPECT_EQ(mean_of({2, 3}).value.x, 2);
  EXPECT_EQ(mean_of({1, 2, 2}).value.x, 2);
  EXPECT_TRUE(mean_of({}).is_open());
}

}  // namespace
}  // namespace pointsweep
