// SPDX-License-Identifier: MIT
/// Statistics of neighbourhoods against their definitions, by brute force over all points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "pointsweep/operators.h"
#include "pointsweep/points/with_type.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/brute_force.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

/// A type that holds float64 and whole numbers of 64 bits exactly.
using Exact = long double;

Exact exact_value(const Records& records, std::size_t row, const std::string& name) {
  const Field& field = records.schema.fields[*records.schema.find(name)];
  return with_type(field.type, [&]<class T>() {
    T value;
    std::memcpy(&value, records.at(row) + field.offset, sizeof value);
    return static_cast<Exact>(value);
  });
}

struct Expected {
  Exact value;
  Exact tolerance = 0;
};

/// Returns a statistic by its definition. `v`: the values in the order of the neighbours.
Expected defined(const std::string& statistic, std::vector<Exact> v) {
  std::erase_if(v, [](Exact value) { return !std::isfinite(value); });
  const auto n = static_cast<Exact>(v.size());
  if (statistic == "count") return {n};
  if (v.empty()) return {std::numeric_limits<Exact>::quiet_NaN()};
  if (statistic == "majority") {
    const auto times = [&](Exact value) { return std::ranges::count(v, value); };
    return {*std::ranges::max_element(v, {}, times)};  // the first of the most frequent values
  }
  Exact sum = 0, squares = 0;
  for (const Exact value : v) sum += value;
  sum /= n;
  for (const Exact value : v) squares += (value - sum) * (value - sum) / n;
  std::ranges::sort(v);
  const Exact spread = 1e-15L * n * (v.back() - v.front()), ulp = 0x1p-52L;
  if (statistic == "mean") return {sum, spread + ulp * std::fabs(sum)};
  if (statistic == "deviation") return {std::sqrt(squares), spread + 1e-18L * n * std::fabs(sum)};
  if (statistic == "min") return {v.front()};
  if (statistic == "max") return {v.back()};
  if (statistic == "range") return {v.back() - v.front(), ulp * (v.back() - v.front())};
  const Exact median = (v[(v.size() - 1) / 2] + v[v.size() / 2]) / 2;
  return {median, v.size() % 2 == 1 && std::fabs(median) < 0x1p53L ? 0 : ulp * std::fabs(median)};
}

const char* const kStatisticNames[] = {"mean", "median", "min", "max", "range", "deviation", "majority", "count"};
const char* const kAttributes[] = {"z", "classification", "intensity", "gain", "id"};

std::string all_statistics(const std::string& condition) {
  std::string text = "statistics(count";
  for (const char* attribute : kAttributes)
    for (const char* statistic : kStatisticNames) text += fmt::format(", {}_{}", attribute, statistic);
  return text + (condition.empty() ? ")" : fmt::format(", where=\"{}\")", condition));
}

struct Condition {
  std::string text;
  std::function<bool(const Records&, std::size_t row)> holds;
};

const std::vector<Condition>& conditions_on_records() {
  static const std::vector<Condition> all = {
      {"", [](const Records&, std::size_t) { return true; }},
      {"classification < 3 && gain > 0.1",
       [](const Records& r, std::size_t i) { return r.value(i, "classification") < 3 && r.value(i, "gain") > 0.1F; }},
      {"id > 9223372036854775900 || x > 0.5", [](const Records& r, std::size_t i) {
         return exact_value(r, i, "id") > 9223372036854775900.0L || r.value(i, "x") > 0.5;
       }}};
  return all;
}

void expect_defined(const Records& in, const Records& out, std::size_t row, const std::string& name,
                    const std::string& statistic, const std::vector<Exact>& values) {
  const Type type = out.schema.fields[*out.schema.find(name)].type;
  Expected expected = defined(statistic, values);
  if (std::isnan(expected.value) && type != Type::f32 && type != Type::f64) expected.value = 0;
  if (statistic == "count" && !is_finite(in.position(row))) expected.value = 0;
  const Exact found = exact_value(out, row, name);
  if (std::isnan(expected.value))
    ASSERT_TRUE(std::isnan(found)) << name << " of row " << row << " is " << found;
  else
    ASSERT_LE(std::fabs(found - expected.value), expected.tolerance) << name << " of row " << row;
}

TEST(NeighborhoodStatistics, AreTheirDefinitionsOnEveryCloudWithEveryNeighborhoodAndCondition) {
  struct Reach {
    std::string text;
    std::size_t k;
    double radius;
  };
  const double far = std::numeric_limits<double>::infinity();
  const Reach reaches[] = {
      {"k=1", 1, far}, {"k=8", 8, far}, {"radius=0.15", 100'000, 0.15}, {"k=5, radius=0.3", 5, 0.3}};
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records in = with_attributes(make_cloud(shape, sized(260), 41));
    const std::vector<Vec3> points = in.positions();
    for (const Reach& reach : reaches) {
      const auto lists = brute_force_neighbors(points, reach.k, reach.radius);
      for (const Condition& condition : conditions_on_records()) {
        const std::string text = "knn(" + reach.text + ") | " + all_statistics(condition.text);
        SCOPED_TRACE(name + ", " + text);
        const Records out = records_of(run_text(in, text, tiny(90)));
        for (std::size_t row = 0; row < points.size(); ++row) {
          std::vector<std::size_t> counted;
          for (const std::uint32_t j : lists[row])
            if (condition.holds(in, j)) counted.push_back(j);
          ASSERT_EQ(out.value(row, "count"), static_cast<double>(counted.size())) << row;
          for (const char* attribute : kAttributes) {
            std::vector<Exact> values;
            for (const std::size_t j : counted) values.push_back(exact_value(in, j, attribute));
            for (const char* statistic : kStatisticNames)
              ASSERT_NO_FATAL_FAILURE(
                  expect_defined(in, out, row, fmt::format("{}_{}", attribute, statistic), statistic, values));
          }
        }
      }
    }
  }
}

/// Returns points on a line at these places, the first at 0, with values of an attribute "v".
template <class Value>
Records on_a_line(const std::vector<double>& places, const std::vector<Value>& values, Type type) {
  Records out;
  for (const char* axis : {"x", "y", "z"}) out.schema.append(axis, Type::f64);
  out.schema.append("v", type);
  out.bytes.resize(places.size() * out.schema.stride);
  for (std::size_t i = 0; i < places.size(); ++i) {
    std::byte* record = out.bytes.data() + i * out.schema.stride;
    std::memcpy(record, &places[i], sizeof(double));
    std::memcpy(record + 3 * sizeof(double), &values[i], sizeof(Value));
  }
  return out;
}

TEST(NeighborhoodStatistics, OfEquallyFrequentValuesTheNearestIsTheMajority) {
  const auto of_first = [](const std::vector<std::uint8_t>& values) {
    const Records in = on_a_line({0, 1, -2, 3, -4, 5}, values, Type::u8);
    return records_of(run_text(in, "knn(k=5) | statistics(v_majority)", {})).value(0, "v_majority");
  };
  EXPECT_EQ(of_first({9, 5, 2, 5, 2, 7}), 5) << "two of both, and 5 is nearer";
  EXPECT_EQ(of_first({9, 7, 2, 5, 2, 5}), 2);
  EXPECT_EQ(of_first({9, 7, 5, 2, 2, 1}), 2) << "the more frequent, though it is farther";
  EXPECT_EQ(of_first({9, 4, 3, 2, 1, 0}), 4);
  EXPECT_EQ(of_first({9, 1, 1, 9, 9, 9}), 9) << "the point's own value does not count";
  EXPECT_EQ(of_first({9, 1, 1, 9, 9, 1}), 1);
}

TEST(NeighborhoodStatistics, TheMeanOfWholeNumbersRoundsTheirSumAlone) {
  constexpr std::uint64_t kOdd = (std::uint64_t{1} << 53) + 1;  // not exact in float64
  const Records in = on_a_line<std::uint64_t>({0, 1, -2, 3}, {0, kOdd, kOdd + 2, kOdd + 2}, Type::u64);
  const Records out = records_of(run_text(in, "knn(k=3) | statistics(v_mean)", {}));
  EXPECT_EQ(out.value(0, "v_mean"), 0x1p53 + 2);
}

TEST(NeighborhoodStatistics, OfWholeNumbersOf64BitsAreExact) {
  const std::uint64_t big = std::numeric_limits<std::uint64_t>::max();
  const Records in = on_a_line<std::uint64_t>({0, 1, -2, 3, -4}, {0, big, big - 1, big - 1, big - 3}, Type::u64);
  const Records out = records_of(
      run_text(in, "knn(k=4) | statistics(v_min, v_max, v_range, v_majority, v_deviation, v_mean, v_median)", {}));
  EXPECT_EQ(exact_value(out, 0, "v_min"), static_cast<Exact>(big - 3));
  EXPECT_EQ(exact_value(out, 0, "v_max"), static_cast<Exact>(big));
  EXPECT_EQ(exact_value(out, 0, "v_majority"), static_cast<Exact>(big - 1));
  EXPECT_EQ(out.value(0, "v_range"), 3);
  EXPECT_DOUBLE_EQ(out.value(0, "v_deviation"), std::sqrt(4.75 / 4));
  EXPECT_EQ(out.value(0, "v_mean"), 0x1p64);
  EXPECT_EQ(out.value(0, "v_median"), 0x1p64);
  EXPECT_EQ(exact_value(out, 1, "v_range"), static_cast<Exact>(0x1p64)) << "18446744073709551614 as float64";

  const std::int64_t low = std::numeric_limits<std::int64_t>::min();
  const Records below = on_a_line<std::int64_t>({0, 1, -2, 3, -4}, {0, low, low + 1, low, 5}, Type::i64);
  const Records of_signed = records_of(run_text(below, "knn(k=3) | statistics(v_min, v_max, v_median, v_range)", {}));
  EXPECT_EQ(exact_value(of_signed, 0, "v_min"), static_cast<Exact>(low));
  EXPECT_EQ(exact_value(of_signed, 0, "v_max"), static_cast<Exact>(low + 1));
  EXPECT_EQ(of_signed.value(0, "v_range"), 1);
  EXPECT_EQ(of_signed.value(0, "v_median"), -0x1p63);
}

TEST(NeighborhoodStatistics, OfEqualValuesAreThatValueWithoutDeviation) {
  const Records in = on_a_line<double>({0, 1, -2, 3, -4, 5, 6}, std::vector<double>(7, 0.1), Type::f64);
  const Records out = records_of(run_text(in, "knn(k=6) | statistics(v_mean, v_median, v_deviation, v_range)", {}));
  EXPECT_EQ(out.value(0, "v_mean"), 0.1);
  EXPECT_EQ(out.value(0, "v_median"), 0.1);
  EXPECT_EQ(out.value(0, "v_deviation"), 0);
  EXPECT_EQ(out.value(0, "v_range"), 0);
}

TEST(NeighborhoodStatistics, HaveTheTypeOfTheAttributeWhereTheyAreValuesOfIt) {
  const Records in = with_attributes(make_cloud(hostile_shapes()[0].second, 50, 1));
  const RunResult out = run_text(in,
                                 "knn(k=4) | normals | " + all_statistics("").substr(0, 10) +
                                     "(nz_min, nz_mean, "
                                     "classification_majority, intensity_max, gain_min, id_max, x_min, id_mean, count)",
                                 {});
  const std::map<std::string, Type> types = {
      {"nz_min", Type::f32},        {"nz_mean", Type::f64},  {"classification_majority", Type::u8},
      {"intensity_max", Type::u16}, {"gain_min", Type::f32}, {"id_max", Type::u64},
      {"x_min", Type::f64},         {"id_mean", Type::f64},  {"count", Type::u32}};
  for (const auto& [name, type] : types) EXPECT_EQ(out.schema.fields[*out.schema.find(name)].type, type) << name;
}

TEST(NeighborhoodStatistics, SeeWhatEarlierStagesMadeOfTheNeighborsAndWhereTheyMovedThem) {
  const Records in = with_attributes(make_cloud(hostile_shapes()[0].second, sized(400), 2));
  const Records out = records_of(run_text(
      in, "knn(k=6) | set(twice = 2 * id) | set(z = 100 * z) | statistics(twice_max, z_mean, count, where=\"z > 0\")",
      tiny(60)));
  const auto lists = brute_force_neighbors(in.positions(), 6);
  for (std::size_t row = 0; row < in.size(); ++row) {
    std::vector<Exact> twice, z;
    for (const std::uint32_t j : lists[row])
      if (in.value(j, "z") > 0) twice.push_back(2 * in.value(j, "id")), z.push_back(100 * in.value(j, "z"));
    ASSERT_NO_FATAL_FAILURE(expect_defined(in, out, row, "twice_max", "max", twice));
    ASSERT_NO_FATAL_FAILURE(expect_defined(in, out, row, "z_mean", "mean", z));
  }
}

TEST(NeighborhoodStatistics, OfAPointAloneAreTheDocumentedValuesAndItIsCounted) {
  const Records in = with_attributes({{1, 2, 3}});
  const RunResult run =
      run_text(in, "knn(k=4) | statistics(z_mean, id_max, classification_majority, count, gain_min)", {});
  const Records out = records_of(run);
  EXPECT_TRUE(std::isnan(out.value(0, "z_mean")) && std::isnan(out.value(0, "gain_min")));
  for (const char* whole : {"id_max", "classification_majority", "count"}) EXPECT_EQ(out.value(0, whole), 0) << whole;
  EXPECT_EQ(run.statistics.degenerate, 1u);
}

TEST(NeighborhoodStatistics, ThatAreLeftOutChangeNoOther) {
  const Records in = with_attributes(make_cloud(hostile_shapes()[1].second, 200, 3));
  const std::string made = "knn(k=5) | statistics(z_mean, count, intensity_median, gain_count, z_range)";
  const Records all = records_of(run_text(in, made, {}));
  const Records some = records_of(run_text(in, made + " | drop(count, z_mean, gain_count)", {}));
  for (std::size_t row = 0; row < in.size(); ++row)
    for (const char* name : {"intensity_median", "z_range"}) EXPECT_EQ(some.value(row, name), all.value(row, name));
}

TEST(NeighborhoodStatistics, RefuseWhatNamesNoStatisticAndNoAttribute) {
  const auto sentence = [](const std::string& text) {
    const Records in = with_attributes({{1, 2, 3}});
    return refusal([&] { run_text(in, text, {}); });
  };
  const auto expect = [&](const std::string& text, const std::string& words) {
    EXPECT_NE(sentence(text).find(words), std::string::npos) << text << "\n" << sentence(text);
  };
  expect("statistics(intensity)", "statistics: 'intensity' names no statistic; write count, or an attribute and mean");
  expect("statistics(intensity_mode)", "'intensity_mode' names no statistic");
  expect("statistics(_mean)", "'_mean' names no statistic");
  expect("statistics(mean)", "'mean' names no statistic");
  expect("statistics(z_mean, z_mean)", "'z_mean' is named twice");
  expect("statistics(height_mean)", "there is no attribute 'height'; there are x, y, z, classification");
  expect("statistics(2_mean)", "'2' is not the name of an attribute");
  expect("normals | statistics(normal_mean)", "'normal' has the components nx, ny, nz");
  expect("statistics(count, where=\"height > 2\")", "statistics: where: 'height > 2', column 1: there is no attribute");
  expect("statistics(count, where=\"z\")", "a comparison is expected");
  expect("statistics()", "the option 'of' is missing");
  EXPECT_EQ(refusal([] { operators::statistics({}); }), "statistics: the option 'of' is missing.");
}

}  // namespace
}  // namespace pointsweep
