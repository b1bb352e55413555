// SPDX-License-Identifier: MIT
/// The name `row` in conditions and values: the number of the point in the inputs, even if earlier stages drop points.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/pipeline/kept_rows.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/reference_engine.h"

namespace pointsweep {
namespace {

/// Returns points of which every 97th has no finite place.
Records numbered_input(int points, std::uint64_t seed) {
  std::vector<Vec3> all = make_cloud(hostile_shapes()[1].second, points, seed);
  for (std::size_t i = 5; i < all.size(); i += 97) all[i].y = std::numeric_limits<double>::quiet_NaN();
  return with_attributes(all);
}

std::vector<std::uint64_t> numbers_of(const RunResult& result) { return values_of<std::uint64_t>(result, {"number"}); }

std::vector<std::uint64_t> sorted(std::vector<std::uint64_t> numbers) {
  std::ranges::sort(numbers);
  return numbers;
}

TEST(Row, SelectsAsTheNumberOfTheInputAlsoAfterOtherSelects) {
  const Records input = numbered_input(900, 71);
  const Records first = input.those([](std::size_t i) { return i < 400; });
  expect_as_over(input, "knn(k=5) | where(row < 400) | normals", first, "knn(k=5) | normals");
  const Records some =
      input.those([&](std::size_t i) { return input.value(i, "classification") < 6 && i >= 300 && i % 900 <= 700; });
  expect_as_over(input,
                 "knn(k=5) | where(classification < 6) | normals | drop(normal) | where(row between 300 and 700)"
                 " | reneighbor(k=4) | density",
                 some, "knn(k=4) | density");
  const Records others = input.those([&](std::size_t i) { return i != 7 && i != 899; });
  expect_as_over(input, "knn(k=3) | where(not row in (7, 899, 1e9)) | density", others, "knn(k=3) | density");
}

TEST(Row, IsTheValueOfASetInEachOrderAndForAllWaysToRun) {
  const Records input = numbered_input(700, 72);
  std::vector<std::uint64_t> expected;
  for (std::size_t i = 0; i < input.size(); ++i)
    if (input.value(i, "classification") < 6) expected.push_back(i);
  const std::string text = "knn(k=4) | where(classification < 6) | normals | set(number = row, as=uint64)";
  for (const EngineOptions& options : ways_to_run(Order::input))
    EXPECT_EQ(numbers_of(run_text(input, text, options)), expected);
  for (const EngineOptions& options : ways_to_run(Order::sweep)) {
    const RunResult result = run_text(input, text, options);
    const std::vector<double> ids = result.field("classification");
    EXPECT_EQ(sorted(numbers_of(result)), expected);
    const std::vector<std::uint64_t> own = values_of<std::uint64_t>(result, {"id"}), numbers = numbers_of(result);
    for (std::size_t i = 0; i < own.size(); ++i) ASSERT_EQ(own[i], (std::uint64_t{1} << 63) + numbers[i]);
  }
  const RunResult alone = run_text(input, "set(number = row, as=uint64)", tiny(100));
  EXPECT_EQ(numbers_of(alone).back(), 699u);
  Schema with_number = input.schema;
  with_number.append("number", Type::u64);
  EXPECT_EQ(alone.schema, with_number);
  const RunResult scaled = run_text(input, "set(intensity = row * 2 where row < 10)", tiny(100));
  EXPECT_EQ(scaled.schema, input.schema);
  for (std::size_t i = 0; i < input.size(); ++i)
    ASSERT_EQ(scaled.field("intensity")[i], i < 10 ? static_cast<double>(2 * i) : input.value(i, "intensity"));
}

TEST(Row, IsOfNeighborsInTheirConditions) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 400, 73));
  Records numbered = records_of(run_text(input, "set(number = row, as=float64)", tiny(100)));
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    const auto counts = [&](const Records& of, const char* name) {
      const std::string text = fmt::format("knn(k=9) | statistics(count, where=\"{} < 200\")", name);
      return run_text(of, text, options).field("count");
    };
    EXPECT_EQ(counts(input, "row"), counts(numbered, "number"));
  }
}

/// One of the inputs has other attributes, so that records are converted. Points without a finite place are dropped.
TEST(Row, CountsAllInputsAndThePointsThatAreDropped) {
  const Records a = numbered_input(300, 74), b = numbered_input(250, 75);
  for (const bool convert : {false, true}) {
    std::vector<std::uint64_t> expected;
    for (std::size_t i = 0; i < 550; ++i) {
      const Vec3 p = i < 300 ? a.position(i) : b.position(i - 300);
      if (is_finite(p) && i % 2 == 0) expected.push_back(i);
    }
    for (EngineOptions options : ways_to_run(Order::input)) {
      options.nonfinite = Nonfinite::drop;
      std::vector<std::unique_ptr<Reader>> readers;
      readers.push_back(std::make_unique<RecordReader>(a.schema, a.bytes));
      Records second = b;
      if (convert) second = records_of(run_text(b, "set(extra = 1, as=uint8) | drop(gain)", tiny(100)));
      readers.push_back(std::make_unique<RecordReader>(second.schema, second.bytes));
      InputCloud cloud(std::move(readers));
      const Schema before = cloud.schema();
      const std::string text =
          "knn(k=3) | set(number = row, as=uint64) | where(row - floor(row / 2) * 2 == 0) | normals";
      EXPECT_EQ(numbers_of(run_in_memory(cloud, chain_of_any_cloud(text), options)), expected);
      EXPECT_EQ(cloud.schema(), before);
      EXPECT_EQ(cloud.count(), 550u);
    }
  }
}

TEST(Row, IsReadByTheReferenceEngine) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 300, 77));
  EngineOptions options = tiny(100);
  options.engine = Engine::reference;
  options.order = Order::sweep;
  const std::string text = "knn(k=5) | set(number = row, as=uint64) | normals";
  const RunResult result = run_text(input, text, options);
  const std::vector<std::uint64_t> own = values_of<std::uint64_t>(result, {"id"}), numbers = numbers_of(result);
  ASSERT_EQ(own.size(), 300u);
  for (std::size_t i = 0; i < own.size(); ++i) ASSERT_EQ(own[i], (std::uint64_t{1} << 63) + numbers[i]);
}

TEST(Row, IsAnAttributeOfThisNameWhereThereIsOne) {
  const Records input = numbered_input(200, 78);
  const RunResult made = run_text(input, "set(row = 3, as=uint8) | set(number = row, as=uint64)", tiny(100));
  EXPECT_EQ(numbers_of(made), std::vector<std::uint64_t>(200, 3));
  const RunResult own = run_text(records_of(made), "set(number = row + 1, as=uint64)", tiny(100));
  EXPECT_EQ(numbers_of(own), std::vector<std::uint64_t>(200, 4));
  const RunResult dropped = run_text(records_of(made), "drop(row, number) | set(number = row, as=uint64)", tiny(100));
  EXPECT_EQ(numbers_of(dropped).back(), 199u);
  const RunResult counted = run_text(input, "set(row = row, as=uint64) | where(row == 7)", tiny(100));
  EXPECT_EQ(values_of<std::uint64_t>(counted, {"row"}), std::vector<std::uint64_t>{7});
}

TEST(Head, KeepsThePointsOfTheFirstRowsWhateverIsLeftOutBefore) {
  const Records input = numbered_input(900, 80);
  const Records first = input.those([](std::size_t i) { return i < 400; });
  expect_as_over(input, "knn(k=5) | head(400) | normals", first, "knn(k=5) | normals");
  const Records some = input.those([&](std::size_t i) { return input.value(i, "classification") < 6 && i < 400; });
  expect_as_over(input, "knn(k=5) | where(classification < 6) | head(400) | density", some, "knn(k=5) | density");
  expect_as_over(input, "knn(k=5) | head(1000000) | density", input, "knn(k=5) | density");
  const Records row_of_3 = records_of(run_text(input, "set(row = 3, as=uint8)", tiny(100)));
  EXPECT_EQ(run_text(row_of_3, "head(2)", tiny(100)).statistics.points_written, 2u) << "no attribute precedes the row";
}

TEST(Row, IsNoAttributeToKeepOrDropAndIsListedInErrors) {
  const Records input = numbered_input(50, 79);
  const auto refused = [&](const std::string& text, const std::vector<std::string>& keep = {}) {
    return refusal([&] { run_text(input, text, tiny(100), keep); });
  };
  EXPECT_NE(refused("where(rwo < 3)").find("there are x, y, z, classification, intensity, gain, id, row."),
            std::string::npos);
  EXPECT_NE(refused("where(row < 3) | drop(row)").find("'row' cannot be dropped; the input has x, "),
            std::string::npos);
  EXPECT_NE(refused("where(row < 3)", {"row"}).find("'row' cannot be kept; the input has x, "), std::string::npos);
  EXPECT_EQ(run_text(input, "where(row < 3)", tiny(100), {"id"}).schema.fields.size(), 4u);
}

}  // namespace
}  // namespace pointsweep
