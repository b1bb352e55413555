// SPDX-License-Identifier: MIT
/// Statistics of points against naive statistics over all values in memory, and `pointsweep info --stats --by
/// --histogram`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/info.h"
#include "pointsweep/info/value_statistics.h"
#include "pointsweep/threads.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using Json = nlohmann::ordered_json;

class PointStatisticsTool : public Tool {
 protected:
  Json statistics_of(const std::string& arguments) {
    const Result result = tool("info --no-spacing --json " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return Json::parse(result.out).at("statistics");
  }
  static Json named(const Json& list, const std::string& name) {
    for (const Json& item : list)
      if (item.at("name") == name) return item;
    ADD_FAILURE() << "no " << name << " in " << list.dump();
    return {};
  }
};

/// Compares statistics with those of the finite values, computed from their definitions.
void expect_statistics(const Json& found, std::vector<double> values) {
  const std::size_t n = values.size();
  ASSERT_EQ(found.at("count"), n);
  if (n == 0) {
    for (const char* key : {"min", "max", "mean", "deviation", "quantiles"})
      EXPECT_TRUE(found.at(key).is_null()) << key;
    return;
  }
  std::ranges::sort(values);
  EXPECT_EQ(found.at("min").get<double>(), values.front());
  EXPECT_EQ(found.at("max").get<double>(), values.back());
  const std::vector<int> percent = {1, 5, 25, 50, 75, 95, 99};
  for (std::size_t q = 0; q < percent.size(); ++q)
    EXPECT_EQ(found.at("quantiles").at(q).get<double>(), values[static_cast<std::size_t>(percent[q]) * (n - 1) / 100])
        << percent[q] << " % of " << n;
  long double sum = 0, squares = 0;
  for (const double v : values) sum += v;
  const long double mean = sum / static_cast<long double>(n);
  for (const double v : values) squares += (v - mean) * (v - mean);
  EXPECT_NEAR(found.at("mean").get<double>(), static_cast<double>(mean),
              1e-13 * static_cast<double>(std::abs(mean)) + 1e-18);
  if (n == 1) {
    EXPECT_TRUE(found.at("deviation").is_null());
    return;
  }
  const double deviation = static_cast<double>(std::sqrt(squares / static_cast<long double>(n - 1)));
  EXPECT_NEAR(found.at("deviation").get<double>(), deviation, 1e-12 * deviation);
}

/// Rows of a text file with the attributes x, y, z, label and value, of which some are NaN or infinite.
struct LabelledRows {
  std::string text = "x,y,z,label,value\n";
  std::map<int, std::vector<double>> z, value;

  LabelledRows(std::size_t n, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < n; ++i) {
      const int label = static_cast<int>(random() % 5) * 100 - 200;
      const double height = std::round(1000 * normal(random)) / 1000 + 5e5;
      const double v = random() % 7 == 0 ? 0.25 : std::exp(20 * normal(random)) * (random() % 2 == 0 ? -1 : 1);
      const bool is_nan = random() % 11 == 0;
      text += fmt::format("{},{},{:.3f},{},{}\n", i, -1.5 * static_cast<double>(i), height, label,
                          is_nan ? "nan" : fmt::format("{}", v));
      z[label].push_back(height);
      if (!is_nan) value[label].push_back(v);
    }
  }
  static std::vector<double> all(const std::map<int, std::vector<double>>& by_label) {
    std::vector<double> together;
    for (const auto& [label, values] : by_label) together.insert(together.end(), values.begin(), values.end());
    return together;
  }
};

TEST_F(PointStatisticsTool, AreThoseOfAllValuesInMemory) {
  for (const std::size_t n : {1u, 2u, 7u, 101u, 5000u}) {
    SCOPED_TRACE(n);
    const LabelledRows rows(n, 17);
    write("a.csv", rows.text);
    const Json found = statistics_of("--stats a.csv");
    EXPECT_EQ(found.at("points"), n);
    EXPECT_TRUE(found.at("by").is_null());
    EXPECT_EQ(found.at("percent"), (Json{1, 5, 25, 50, 75, 95, 99}));
    ASSERT_EQ(found.at("groups").size(), 1u);
    const Json& group = found.at("groups")[0];
    EXPECT_TRUE(group.at("value").is_null());
    EXPECT_EQ(group.at("attributes").size(), 5u);
    expect_statistics(named(group.at("attributes"), "z"), LabelledRows::all(rows.z));
    const std::vector<double> values = LabelledRows::all(rows.value);
    expect_statistics(named(group.at("attributes"), "value"), values);
    EXPECT_EQ(named(group.at("attributes"), "value").at("nonfinite"), n - values.size());
  }
}

TEST_F(PointStatisticsTool, OfEachValueAreThoseOfItsPoints) {
  const LabelledRows rows(3000, 5);
  write("a.csv", rows.text);
  const Json found = statistics_of("--stats --by label --keep value,z a.csv");
  EXPECT_EQ(found.at("by"), "label");
  ASSERT_EQ(found.at("groups").size(), rows.z.size());
  auto group = found.at("groups").begin();
  for (const auto& [label, z] : rows.z) {
    SCOPED_TRACE(label);
    EXPECT_EQ(group->at("value"), label);
    EXPECT_EQ(group->at("points"), z.size());
    ASSERT_EQ(group->at("attributes").size(), 2u);
    expect_statistics(group->at("attributes")[0], z);
    expect_statistics(group->at("attributes")[1], rows.value.at(label));
    ++group;
  }
}

TEST_F(PointStatisticsTool, DoNotDependOnOrderFilesThreadsAndFormat) {
  const LabelledRows rows(2000, 9);
  write("a.csv", rows.text);
  std::vector<std::string> lines;
  for (std::size_t at = rows.text.find('\n') + 1; at < rows.text.size();) {
    const std::size_t end = rows.text.find('\n', at) + 1;
    lines.push_back(rows.text.substr(at, end - at));
    at = end;
  }
  std::ranges::shuffle(lines, std::mt19937_64(3));
  const std::string header = "x,y,z,label,value\n";
  std::filesystem::create_directory(folder_ / "t");
  for (std::size_t file = 0; file < 40; ++file) {
    std::string text = header;
    for (std::size_t i = file; i < lines.size(); i += 40) text += lines[i];
    write(fmt::format("t/{}.csv", file), text);
  }
  made("convert a.csv a.ply -q");
  const std::string asked = "--stats --by label --histogram z,value ";
  const Json one = statistics_of(asked + "a.csv");
  EXPECT_EQ(statistics_of(asked + "t"), one);
  const Json ply = statistics_of(asked + "a.ply");
  for (std::size_t g = 0; g < one.at("groups").size(); ++g)
    EXPECT_EQ(named(ply.at("groups")[g].at("attributes"), "value"),
              named(one.at("groups")[g].at("attributes"), "value"));
  for (const unsigned threads : {1u, 3u}) {
    Cloud cloud({folder_ / "a.csv"});
    PointStatisticsOptions options;
    options.by = "label";
    options.values = true;
    options.histograms = {"z", "value"};
    std::string json;
    with_threads(threads, [&] { json = to_json(point_statistics(cloud, options)); });
    EXPECT_EQ(Json::parse(json), one);
  }
}

TEST_F(PointStatisticsTool, KeepWholeNumbersOf64Bits) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "property int64 id\nproperty uint64 key\nend_header\n";
  write("a.ply", ply +
                     "0 0 0 -9223372036854775808 18446744073709551615\n1 0 0 9007199254740993 18446744073709551614\n"
                     "2 0 0 9007199254740992 18446744073709551613\n3 0 0 9223372036854775807 0\n");
  const Json list = statistics_of("--stats a.ply").at("groups")[0].at("attributes");
  const Json id = named(list, "id"), key = named(list, "key");
  EXPECT_EQ(id.at("min").get<std::int64_t>(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(id.at("max").get<std::int64_t>(), std::numeric_limits<std::int64_t>::max());
  // Ranks 0, 0, 0, 1, 2, 2, 2 of four values.
  EXPECT_EQ(id.at("quantiles")[3].get<std::int64_t>(), 9007199254740992);
  EXPECT_EQ(id.at("quantiles")[4].get<std::int64_t>(), 9007199254740993);
  EXPECT_EQ(key.at("max").get<std::uint64_t>(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(key.at("quantiles")[3].get<std::uint64_t>(), 18446744073709551613u);
  EXPECT_EQ(id.at("mean").get<double>(), 18014398509481984.0 / 4);  // the sum is 2^54, and -1 + 1
  const Json by = statistics_of("--by key a.ply").at("groups");
  ASSERT_EQ(by.size(), 4u);
  EXPECT_EQ(by[0].at("value").get<std::uint64_t>(), 0u);
  EXPECT_EQ(by[3].at("value").get<std::uint64_t>(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(statistics_of("--by id a.ply").at("groups")[0].at("value").get<std::int64_t>(),
            std::numeric_limits<std::int64_t>::min());
}

TEST_F(PointStatisticsTool, DeviationOfCloseValuesFarFromZeroIsExact) {
  std::string text = "x,y,z,t\n";
  for (int i = 0; i < 1000; ++i) text += fmt::format("0,0,{},{}\n", i, 1e9 + (i % 2 == 0 ? 0 : 0x1p-20));
  write("a.csv", text);
  const Json t = named(statistics_of("--stats a.csv").at("groups")[0].at("attributes"), "t");
  EXPECT_DOUBLE_EQ(t.at("deviation").get<double>(), 0x1p-21 * std::sqrt(1000.0 / 999));
}

TEST_F(PointStatisticsTool, BeyondFloat64AreAbsent) {
  write("a.csv", "x,y,z,v,w\n0,0,1,1.7e308,1e200\n0,0,2,1.7e308,3e200\n0,0,3,-1.7e308,2e200\n0,0,4,1.7e308,2e200\n");
  const Json list = statistics_of("--stats a.csv").at("groups")[0].at("attributes");
  EXPECT_TRUE(named(list, "v").at("mean").is_null());
  EXPECT_TRUE(named(list, "v").at("deviation").is_null());
  EXPECT_EQ(named(list, "v").at("min"), -1.7e308);
  EXPECT_EQ(named(list, "w").at("mean"), 2e200);
  EXPECT_TRUE(named(list, "w").at("deviation").is_null());
}

TEST_F(PointStatisticsTool, OfNoPointsHaveNoValues) {
  write("none.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar label\nend_header\n");
  const Json found = statistics_of("--stats --histogram z none.ply");
  ASSERT_EQ(found.at("groups").size(), 1u);
  expect_statistics(found.at("groups")[0].at("attributes")[2], {});
  EXPECT_EQ(found.at("groups")[0].at("histograms")[0].at("counts"), Json::array());
  EXPECT_EQ(statistics_of("--stats --by label none.ply").at("groups"), Json::array());
  write("nan.csv", "x,y,z,v\n1,2,3,nan\n1,2,inf,nan\n");
  const Json v = statistics_of("--stats --histogram v nan.csv").at("groups")[0];
  expect_statistics(named(v.at("attributes"), "v"), {});
  EXPECT_EQ(named(v.at("attributes"), "v").at("nonfinite"), 2);
  expect_statistics(named(v.at("attributes"), "z"), {3});
  EXPECT_NE(tool("info --stats --histogram v nan.csv").out.find("histogram of v\n  no finite value\n"),
            std::string::npos);
}

TEST_F(PointStatisticsTool, CountValuesBetweenTheEdgesOfAHistogram) {
  const LabelledRows rows(2000, 23);
  write("a.csv", rows.text);
  const std::vector<double> z = LabelledRows::all(rows.z);
  for (const std::size_t bins : {2u, 3u, 20u, 1000u}) {
    const Json group = statistics_of(fmt::format("--histogram z --bins {} a.csv", bins)).at("groups")[0];
    EXPECT_TRUE(group.at("attributes").empty());
    const Json h = named(group.at("histograms"), "z");
    const auto edges = h.at("edges").get<std::vector<double>>();
    const auto counts = h.at("counts").get<std::vector<std::uint64_t>>();
    ASSERT_EQ(edges.size(), counts.size() + 1);
    EXPECT_LE(counts.size(), bins);
    EXPECT_GT(3 * counts.size() + 3, bins) << "bins are not much wider than they have to be";
    for (std::size_t i = 0; i < counts.size(); ++i)
      EXPECT_EQ(counts[i], std::ranges::count_if(z, [&](double v) { return v >= edges[i] && v < edges[i + 1]; }));
    EXPECT_TRUE(counts.front() > 0 && counts.back() > 0);
  }
  const Json of_values = statistics_of("--histogram z --by label a.csv").at("groups");
  std::uint64_t points = 0;
  for (const Json& group : of_values) {
    EXPECT_EQ(group.at("histograms")[0].at("edges"), of_values[0].at("histograms")[0].at("edges"));
    for (const Json& count : group.at("histograms")[0].at("counts")) points += count.get<std::uint64_t>();
  }
  EXPECT_EQ(points, z.size());
}

TEST(HistogramBins, LieBetweenRoundNumbers) {
  const auto edges_of = [](Type type, double lo, double hi, std::uint64_t bins) {
    const Field field{.name = "v", .type = type};
    const ValueKeys keys(field);
    std::vector<std::byte> records(16);
    Field second = field;
    second.offset = 8;
    set_value(field, records.data(), lo);
    set_value(second, records.data(), hi);
    std::vector<std::uint64_t> found;
    keys.find(records, 8, found);
    return HistogramBins(keys, found[0], found[1], bins).edges();
  };
  EXPECT_EQ(edges_of(Type::u8, 1, 6, 20), (std::vector<double>{1, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(edges_of(Type::i16, -7, 23, 20),
            (std::vector<double>{-8, -6, -4, -2, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24}));
  EXPECT_EQ(edges_of(Type::f64, -0.1, 0.15, 4), (std::vector<double>{-0.1, 0, 0.1, 0.2}));
  EXPECT_EQ(edges_of(Type::f64, 0.3, 0.7, 5), (std::vector<double>{0.3, 0.4, 0.5, 0.6, 0.7, 0.8}));
  EXPECT_EQ(edges_of(Type::f64, 0.3, 0.7, 4), (std::vector<double>{0.2, 0.4, 0.6, 0.8}));
  EXPECT_EQ(edges_of(Type::f64, 310.2, 349.9, 4), (std::vector<double>{310, 320, 330, 340, 350}));
  EXPECT_EQ(edges_of(Type::f64, 5.5, 5.5, 20), (std::vector<double>{5, 6}));
  EXPECT_EQ(edges_of(Type::f32, 0, 0, 2), (std::vector<double>{0, 1}));
  EXPECT_EQ(edges_of(Type::f64, -1, 1, 2), (std::vector<double>{-2, 0, 2}));
}

TEST(HistogramBins, OfAnyRangeAreAscendingAndFew) {
  std::mt19937_64 random(4);
  const ValueKeys keys(Field{.name = "v", .type = Type::f64});
  for (int i = 0; i < 3000; ++i) {
    std::vector<double> values = {std::bit_cast<double>(random()), std::bit_cast<double>(random())};
    if (i % 3 == 0) values[1] = values[0] * (1 + 0x1p-50);
    if (i % 97 == 0) values = {-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
    if (!std::isfinite(values[0]) || !std::isfinite(values[1])) continue;
    std::ranges::sort(values);
    std::vector<std::uint64_t> found;
    keys.find(std::as_bytes(std::span(values)), 8, found);
    const HistogramBins bins(keys, found[0], found[1], 10);
    const std::vector<double> edges = bins.edges();
    EXPECT_TRUE(std::ranges::is_sorted(edges)) << values[0] << " " << values[1];
    EXPECT_LE(edges.size(), 11u);
    for (std::size_t v : {0u, 1u}) {
      const std::size_t bin = bins.bin_of(keys, found[v]);
      EXPECT_LE(edges[bin], values[v]);
      EXPECT_TRUE(edges[bin + 1] > values[v] || values[v] == std::numeric_limits<double>::max()) << values[v];
    }
  }
}

TEST(RankSearch, FindsRanksInAnyRoom) {
  std::mt19937_64 random(8);
  for (const std::uint64_t share : {2u, 3u, 16u, 1000u}) {
    for (int round = 0; round < 40; ++round) {
      std::vector<std::uint64_t> keys(1 + random() % 700);
      const int shift = static_cast<int>(random() % 64);
      for (std::uint64_t& key : keys) key = random() >> shift << (random() % 3);
      if (round % 4 == 0) keys.front() = 0, keys.back() = std::numeric_limits<std::uint64_t>::max();
      std::vector<std::uint64_t> sorted = keys;
      std::ranges::sort(sorted);
      RankSearch search(keys.size(), sorted.front(), sorted.back());
      int readings = 0;
      while (search.open() > 0) {
        std::uint64_t numbers = 0;
        search.begin(share, numbers);
        EXPECT_LE(numbers, share * search.open());
        std::vector<std::uint64_t> room(numbers, 0);
        for (const std::uint64_t key : keys) search.add(key, room);
        search.end(room);
        ASSERT_LE(++readings, 64);
      }
      for (std::size_t r = 0; r < RankSearch::kRanks; ++r)
        EXPECT_EQ(search.keys()[r], sorted[PointStatistics::kPercent[r] * (keys.size() - 1) / 100]);
    }
  }
}

TEST(RankSearch, NoticesOtherKeysInALaterReading) {
  RankSearch search(3, 1, 1000);
  std::uint64_t numbers = 0;
  search.begin(2, numbers);
  std::vector<std::uint64_t> room(numbers, 0);
  search.add(1, room);
  EXPECT_THROW(search.end(room), Error);
}

TEST_F(PointStatisticsTool, AreShownAsTables) {
  write("a.csv", "x,y,z,classification\n0,0,1,2\n1,0,2,2\n2,0,3,2\n3,0,10,5\n");
  const std::string out = tool("info --by classification --stats --keep z --histogram z --bins 5 a.csv").out;
  const std::string expected =
      "points by classification\n"
      "  classification     points    share\n"
      "  2 Ground                3  75.00 %\n"
      "  5 High vegetation       1  25.00 %\n"
      "statistics of 4 points\n"
      "  classification     attribute  count  min  1 %  5 %  25 %  50 %  75 %  95 %  99 %  max  mean  deviation\n"
      "  2 Ground           z              3    1    1    1     1     2     2     2     2    3     2          1\n"
      "  5 High vegetation  z              1   10   10   10    10    10    10    10    10   10    10          -\n"
      "histogram of z, classification 2 Ground\n"
      "  from  to  count\n"
      "     0   5      3  ########################################\n"
      "     5  10      0\n"
      "    10  15      0\n";
  EXPECT_NE(out.find(expected), std::string::npos) << out;
}

TEST_F(PointStatisticsTool, GoOnWithoutFilesThatCannotBeRead) {
  write("a.csv", "x,y,z\n0,0,1\n");
  write("b.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nend_header\n");
  const Result result = tool("info --json --stats a.csv b.ply");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(Json::parse(result.out).at("statistics").at("points"), 1);
  const Result none = tool("info --json --stats b.ply");
  EXPECT_EQ(none.status, 1);
  EXPECT_TRUE(Json::parse(none.out).at("statistics").is_null());
}

TEST_F(PointStatisticsTool, ReadTextWhoseColumnsAreNamedAndStandardInput) {
  write("a.txt", "1 2 3 7\n4 5 6 7\n7 8 9 1\n");
  const Json found = statistics_of("--columns x,y,z,label --by label a.txt");
  ASSERT_EQ(found.at("groups").size(), 2u);
  EXPECT_EQ(found.at("groups")[1].at("points"), 2);
}

TEST_F(PointStatisticsTool, RefuseWhatCannotBe) {
  write("a.csv", "x,y,z,label,id\n0,0,1.5,1,0\n");
  refused(2, "info --by nothing a.csv", "--by: the points have no attribute 'nothing'; they have x, y, z, label, id");
  refused(2, "info --by z a.csv", "--by: 'z' has the value 1.5, and points are grouped by whole numbers; make");
  refused(2, "info --by z a.csv", "'set(part = floor(z), as=int32)'");
  made("run a.csv whole.ply --pipeline 'set(part = floor(z), as=int32)'");
  EXPECT_EQ(statistics_of("--by part whole.ply").at("groups")[0].at("value"), 1) << "the remedy of the sentence";
  refused(2, "info --stats --keep q a.csv", "--keep: the points have no attribute 'q'");
  refused(2, "info --histogram q a.csv", "--histogram: the points have no attribute 'q'");
  refused(2, "info --histogram z --bins 1 a.csv", "--bins: 1 is not from 2 to 1000");
  refused(2, "info --histogram z --bins 1001 a.csv", "--bins: 1001 is not from 2 to 1000");
  for (const char* option : {"--by label", "--stats", "--histogram z"})
    EXPECT_EQ(tool(fmt::format("info --quick {} a.csv", option)).status, 2) << option;
  write("nan.csv", "x,y,z,label\n0,0,0,1\n0,0,0,nan\n");
  refused(2, "info --by label nan.csv", "--by: 'label' has the value nan");
  EXPECT_EQ(tool("info --keep z a.csv").status, 2);
  EXPECT_EQ(tool("info --bins 3 a.csv").status, 2);
  std::string text = "x,y,z,id\n";
  for (int i = 0; i <= 10'000; ++i) text += fmt::format("0,0,0,{}\n", i);
  write("many.csv", text);
  refused(2, "info --by id many.csv", "'id' has more than 10000 values; choose an attribute that has fewer values.");
}

}  // namespace
}  // namespace pointsweep
