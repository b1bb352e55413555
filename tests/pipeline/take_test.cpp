// SPDX-License-Identifier: MIT
/// The operator take against votes by their formulas, over all points of the other cloud.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <tuple>

#include "pointsweep/error.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Returns the k nearest points within `most`, nearest first, equal distances by x, y, z, row.
std::vector<std::size_t> nearest_rows(const Records& other, Vec3 p, std::size_t k, double most) {
  std::vector<std::tuple<double, double, double, double, std::size_t>> all;
  for (std::size_t i = 0; i < other.size(); ++i) {
    const Vec3 q = other.position(i);
    const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z, d2 = (x * x + y * y) + z * z;
    if (is_finite(q) && d2 <= most * most) all.emplace_back(d2, q.x, q.y, q.z, i);
  }
  std::ranges::sort(all);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < std::min(k, all.size()); ++i) rows.push_back(std::get<4>(all[i]));
  return rows;
}

/// Returns the vote; nothing if no value counts. The mean of whole numbers is taken from their exact sum.
std::optional<double> vote(const std::string& how, std::vector<double> values, bool are_whole) {
  if (values.empty()) return {};
  if (how == "nearest" || (how == "majority" && values.size() == 1)) return values.front();
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {};
  const double first = are_whole ? 0 : values.front();
  double sum = 0;
  std::map<double, int> counts;
  for (const double v : values) sum += v - first, ++counts[v];
  if (how == "mean") return first + sum / static_cast<double>(values.size());
  double best = values.front();
  for (const double v : values)
    if (counts[v] > counts[best]) best = v;
  return best;
}

struct Column {
  std::string name;
  Type type;
  std::vector<double> values;
};

/// Returns points with x, y, z f64 and some attributes.
Records with_columns(const std::vector<Vec3>& points, const std::vector<Column>& columns) {
  Records out;
  for (const char* axis : {"x", "y", "z"}) out.schema.append(axis, Type::f64);
  for (const Column& column : columns) out.schema.append(column.name, column.type);
  out.bytes.resize(points.size() * out.schema.stride);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::byte* const record = out.bytes.data() + i * out.schema.stride;
    for (std::size_t a = 0; a < 3; ++a) set_value(out.schema.fields[a], record, points[i][static_cast<int>(a)]);
    for (std::size_t c = 0; c < columns.size(); ++c) set_value(out.schema.fields[3 + c], record, columns[c].values[i]);
  }
  return out;
}

template <class Work>
std::string said_by(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

bool is_equal(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

class TakeOf : public testing::Test {
 protected:
  std::string written(const Records& records) {
    const std::filesystem::path path = folder_ / fmt::format("other{}.pcd", ++files_);
    write_all(plan_for(path, records.size(), records.schema), records.bytes);
    return path.string();
  }
  /// Writes the other cloud, and returns a stage that takes attributes from it.
  std::string taking(const Records& other, const std::string& options) {
    return fmt::format("take(\"{}\", {})", written(other), options);
  }
  static void expect(const std::vector<double>& got, const std::vector<double>& expected, const std::string& what) {
    ASSERT_EQ(got.size(), expected.size()) << what;
    for (std::size_t i = 0; i < got.size(); ++i)
      ASSERT_TRUE(is_equal(got[i], expected[i])) << what << ", row " << i << ": " << got[i] << ", not " << expected[i];
  }

  const TemporaryFolder folder_;
  int files_ = 0;
};

TEST_F(TakeOf, GivesWhatTheNearestOfAllPointsVoteFor) {
  const std::vector<std::tuple<std::size_t, std::string, double>> rules = {
      {1, "nearest", INFINITY}, {1, "majority", 0.05}, {5, "majority", INFINITY},
      {6, "majority", 0.3},     {4, "mean", INFINITY}, {1000, "mean", 0.4}};
  const std::string fields[] = {"classification", "intensity", "gain"};
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records points = with_attributes(make_cloud(shape, sized(120), 3), 5);
    const Records other = with_attributes(make_cloud(shape, sized(100), 4), 6);
    const std::string file = written(other);
    for (const auto& [k, how, most] : rules) {
      std::map<std::string, std::vector<double>> expected;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const std::vector<std::size_t> rows = nearest_rows(other, points.position(i), k, most);
        for (const std::string& field : fields) {
          std::vector<double> values;
          for (const std::size_t row : rows) values.push_back(other.value(row, field));
          const bool whole = field != "gain";
          double given = points.value(i, field);
          if (is_finite(points.position(i))) given = vote(how, values, whole).value_or(given);
          expected[field].push_back(whole ? std::nearbyint(given) : static_cast<float>(given));
        }
      }
      const std::string limit = std::isfinite(most) ? fmt::format(", most={}", most) : "";
      const std::string stage = fmt::format(
          "take(\"{}\", attributes=[classification, intensity, gain], k={}, vote={}{})", file, k, how, limit);
      for (const EngineOptions& options : ways_to_run()) {
        const RunResult got = run_text(points, stage, options);
        for (const std::string& field : fields)
          expect(got.field(field), expected[field], name + " " + stage + " " + field);
      }
    }
  }
}

TEST_F(TakeOf, NewAttributesHaveTheTypeOfTheOtherCloudAndMeansAreFloat64) {
  const std::vector<Vec3> places = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const Records points = with_columns({{0.1, 0, 0}, {9, 0, 0}, {kUnknown, 0, 0}}, {});
  const Records other = with_columns(places, {{"tree", Type::u32, {7, 4'000'000'000, 8}},
                                              {"far", Type::i16, {-3, -5, -8}},
                                              {"w", Type::f32, {0.5, kUnknown, 2}}});
  const auto of = [&](const std::string& options) { return run_text(points, taking(other, options), tiny(700)); };
  const RunResult nearest = of("attributes=[Tree, far, w]");
  const auto type = [](const RunResult& r, const char* name) { return r.schema.fields[*r.schema.find(name)].type; };
  EXPECT_EQ(type(nearest, "tree"), Type::u32);
  EXPECT_EQ(type(nearest, "far"), Type::i16);
  EXPECT_EQ(type(nearest, "w"), Type::f32);
  expect(nearest.field("tree"), {7, 8, 0}, "without a place: 0");
  expect(nearest.field("far"), {-3, -8, 0}, "");
  expect(nearest.field("w"), {0.5, 2, kUnknown}, "");
  const RunResult mean = of("attributes=[tree, far, w], k=2, vote=mean");
  EXPECT_EQ(type(mean, "far"), Type::f64);
  expect(mean.field("tree"), {2'000'000'003.5, 2'000'000'004, kUnknown}, "");
  expect(mean.field("far"), {-4, -6.5, kUnknown}, "");
  expect(mean.field("w"), {0.5, 2, kUnknown}, "NaN has no vote");
  const RunResult missing = of("attributes=[tree, w], most=1, missing=99");
  expect(missing.field("tree"), {7, 99, 0}, "");
  expect(missing.field("w"), {0.5, 99, kUnknown}, "");
  expect(of("attributes=w, most=1").field("w"), {0.5, kUnknown, kUnknown}, "NaN without another");
  expect(of("attributes=tree, most=7, missing=1").field("tree"), {7, 8, 0}, "most is inclusive");
}

TEST_F(TakeOf, WholeNumbersOf64BitsAreExact) {
  const Records own = with_attributes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {kUnknown, 0, 0}});
  const Records other = with_attributes({{2, 0, 0}, {1, 0, 0}, {3, 0, 0}, {1, 0, 0}});
  const RunResult got = run_text(own, taking(other, "attributes=id, most=0.5"), tiny(100));
  const std::vector<std::uint64_t> rows = {0, 1, 0, 2, 4};  // own rows at both ends, else rows of `other`
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::uint64_t id = 0;
    const Field& field = got.schema.fields[*got.schema.find("id")];
    std::memcpy(&id, got.records.data() + i * got.schema.stride + field.offset, sizeof id);
    EXPECT_EQ(id, (std::uint64_t{1} << 63) + rows[i]) << i;
  }
}

TEST_F(TakeOf, ColoursKeepTheirBrightness) {
  const std::vector<Vec3> places = {{0, 0, 0}, {1, 0, 0}};
  const auto colors = [&](Type type, double a, double b) {
    return with_columns(places, {{"red", type, {a, b}}, {"green", type, {b, a}}, {"blue", type, {a, a}}});
  };
  const Records narrow = colors(Type::u8, 255, 16), wide = colors(Type::u16, 65535, 4112 + 128);
  const std::string all = "attributes=[red, green, blue]";
  expect(run_text(wide, taking(narrow, all), tiny(700)).field("green"), {4112, 65535}, "8 to 16 bits");
  expect(run_text(narrow, taking(wide, all), tiny(700)).field("green"), {16, 255}, "16 to 8 bits");
  const Records none = with_columns(places, {});
  const RunResult mean = run_text(none, taking(narrow, all + ", k=2, vote=mean"), tiny(700));
  EXPECT_EQ(mean.schema.fields[*mean.schema.find("red")].type, Type::u8);
  expect(mean.field("red"), {136, 136}, "135.5, halves to even");
  const RunResult part = run_text(none, "color(by=x, bits=16) | " + taking(narrow, "attributes=green"), tiny(100));
  expect(part.field("green"), {4112, 65535}, "a channel of a colour that was made");
  expect(part.field("red"), run_text(none, "color(by=x, bits=16)", tiny(100)).field("red"), "the others stay");
}

TEST_F(TakeOf, APointThatWasKeptHasItsOwnLabelAgain) {
  const Records points = with_attributes(make_cloud(hostile_shapes().front().second, sized(900), 3), 5);
  const Records thin = records_of(run_text(points, "voxel(size=0.2)", tiny(700)));
  ASSERT_LT(thin.size(), points.size() / 2);
  const RunResult back = run_text(points, taking(thin, "attributes=[intensity, id]"), tiny(100));
  std::map<std::tuple<double, double, double>, double> intensity;
  for (std::size_t i = 0; i < thin.size(); ++i) {
    const Vec3 p = thin.position(i);
    intensity[{p.x, p.y, p.z}] = thin.value(i, "intensity");
  }
  std::size_t seen = 0;
  const std::vector<double> got = back.field("intensity");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points.position(i);
    const auto own = intensity.find({p.x, p.y, p.z});
    if (own == intensity.end()) continue;
    EXPECT_EQ(got[i], own->second);
    ++seen;
  }
  EXPECT_EQ(seen, thin.size());
}

TEST_F(TakeOf, LaterStagesReadWhatWasTakenAndDropsLetANewTypeIn) {
  const Records points = with_columns({{0, 0, 0}, {1, 0, 0}}, {{"label", Type::u8, {1, 2}}});
  const Records other =
      with_columns({{0, 0, 0}, {1, 0, 0}}, {{"label", Type::f64, {2.5, 300}}, {"n", Type::i64, {3, -4}}});
  const std::string stage = taking(other, "attributes=[label, n]");
  EXPECT_EQ(said_by([&] { run_text(points, stage, tiny(700)); }),
            "pipeline, column 1: take: row 0: 'label' would be 2.5, which is not uint8, 0 to 255; drop(label) before "
            "lets it have the type "
            "of " +
                (folder_ / "other1.pcd").string() + ".");
  const RunResult fresh = run_text(points, "drop(label) | " + stage + " | where(n > 0)", tiny(100));
  expect(fresh.field("label"), {2.5}, "");
}

TEST_F(TakeOf, AWholeNumberThatItsTypeCannotHoldIsRefused) {
  const std::vector<Vec3> places = {{0, 0, 0}, {1, 0, 0}};
  const Records points = with_columns(places, {{"label", Type::u8, {1, 2}}});
  for (const auto& [type, value] : {std::pair(Type::u16, 300.0), {Type::i16, -1.0}, {Type::i64, 4294967296.0}}) {
    const Records other = with_columns(places, {{"label", type, {255, value}}});
    const std::string got = said_by([&] { run_text(points, taking(other, "attributes=label"), tiny(700)); });
    EXPECT_NE(got.find(fmt::format("row 1: 'label' would be {:.0f}, which is not uint8", value)), std::string::npos)
        << got;
  }
}

TEST_F(TakeOf, LengthsOfTheOtherCloudHaveTheirUnit) {
  const std::vector<Vec3> places = {{0, 0, 0}, {1, 0, 0}};
  const Records other = with_columns(places, {{"mean_distance", Type::f64, {1, 2}}, {"share", Type::f64, {3, 4}}});
  const RunResult got =
      run_text(with_columns(places, {}), taking(other, "attributes=[mean_distance, share]") + " | transform(scale=10)",
               tiny(100));
  expect(got.field("mean_distance"), {10, 20}, "");
  expect(got.field("share"), {3, 4}, "");
}

TEST_F(TakeOf, SaysWhatIsWrong) {
  const std::vector<Vec3> places = {{0, 0, 0}, {1, 0, 0}};
  const Records points = with_attributes(places);
  const Records other = with_columns(places, {{"label", Type::u8, {1, 2}}, {"intensity", Type::f64, {70'000, 1}}});
  const auto sentence = [&](const Records& from, const std::string& options) {
    return said_by([&] { run_text(points, taking(from, options), tiny(700)); });
  };
  const auto says = [&](const Records& from, const std::string& options, const std::string& words) {
    const std::string got = sentence(from, options);
    EXPECT_NE(got.find(words), std::string::npos) << options << ": " << got;
  };
  says(other, "attributes=labels", "has no attribute 'labels'; the nearest it has are 'label'");
  says(other, "attributes=[label, Label]", "'label' and 'Label' are the same attribute");
  says(with_columns(places, {{"gain", Type::u8, {1, 2}}, {"Gain", Type::u8, {1, 2}}}), "attributes=[gain, Gain]",
       "'gain' and 'Gain' are the same attribute of the points");
  says(other, "attributes=[label, label]", "'label' is named twice");
  says(other, "attributes=[label, z]", "'z' is a coordinate");
  says(other, "attributes=label, k=0", "k is a whole number, 1 to 1000");
  says(other, "attributes=label, k=2, vote=nearest", "leave out k=2");
  says(other, "attributes=label, missing=1", "missing is used only with most");
  says(other, "attributes=label, most=1", "'label' is new, and uint8 cannot say");
  says(other, "attributes=label, most=1, missing=256", "missing=256 is not uint8, 0 to 255");
  says(other, "attributes=label, most=1, missing=0.5", "missing=0.5 is not uint8");
  says(other, "attributes=intensity", "row 0: 'intensity' would be 70000, which is not uint16, 0 to 65535");
  says(other, "k=1", "the option 'attributes' is missing");
  says(with_columns(places, {}), "attributes=label", "has no attributes to take, only positions");
  says(with_columns({{kUnknown, 0, 0}}, {{"label", Type::u8, {1}}}), "attributes=label",
       "has no point with a finite place");
  says(with_columns({}, {{"label", Type::u8, {}}}), "attributes=label", "no points");
}

}  // namespace
}  // namespace pointsweep
