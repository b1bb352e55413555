// SPDX-License-Identifier: MIT
/// The operators set and drop against plain loops over the records.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <tuple>

#include "pointsweep/operators.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

/// Returns options with different threads and slabs, spilled and in memory.
std::vector<EngineOptions> ways_of_editing(Order order) {
  std::vector<EngineOptions> all = {tiny(100, false, 1), tiny(100, true, 2), tiny(50'000, false, 3)};
  for (EngineOptions& options : all) options.order = order;
  return all;
}

std::size_t index_of(const Schema& schema, const std::string& name) {
  for (std::size_t f = 0; f < schema.fields.size(); ++f)
    if (schema.fields[f].name == name) return f;
  ADD_FAILURE() << "no field " << name;
  return 0;
}

/// Returns `input` after edit(field bytes, row) for every row, including rows without a finite place.
template <class Edit>
Records edited(Records input, const std::string& field, Edit edit) {
  const Field& f = input.schema.fields[index_of(input.schema, field)];
  for (std::size_t i = 0; i < input.size(); ++i) {
    std::byte* record = input.bytes.data() + i * input.schema.stride;
    edit(record + f.offset, i);
  }
  return input;
}

template <class T>
void put_as(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof value);
}

std::string editing_error(const Records& input, const std::string& pipeline, EngineOptions options = tiny(100)) {
  try {
    run_text(input, pipeline, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Set, AssignsWhereTheConditionHoldsAndKeepsTypes) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Records input = with_attributes(make_cloud(shape, sized(700), 3));
    const Records classes = edited(input, "classification", [&](std::byte* to, std::size_t i) {
      if (input.value(i, "intensity") > 30000 || input.value(i, "z") < 0.25) put_as<std::uint8_t>(to, 7);
    });
    const Records halves = edited(input, "intensity", [&](std::byte* to, std::size_t i) {
      put_as(to, static_cast<std::uint16_t>(std::nearbyint(input.value(i, "intensity") / 2)));
    });
    const Records gains = edited(input, "gain", [&](std::byte* to, std::size_t i) {
      if (input.value(i, "classification") != 3)
        put_as(to, static_cast<float>(input.value(i, "gain") * 3 - input.value(i, "x") / 7));
    });
    const Records ids = edited(input, "id", [&](std::byte* to, std::size_t i) {
      if (i % 2 == 0 && i < 2) put_as(to, std::uint64_t{18446744073709551615u});
    });
    const std::pair<const char*, const Records*> edits[] = {
        {"set(classification = 7 where intensity > 30000 || z < 0.25)", &classes},
        {"set(intensity = intensity / 2)", &halves},
        {"set(gain = gain * 3 - x / 7 where classification != 3)", &gains},
        {"set(id = 18446744073709551615 where id == 9223372036854775808)", &ids}};
    for (const auto& [pipeline, expected] : edits) {
      const RunResult plain = run_text(input, pipeline, tiny(300));
      ASSERT_EQ(plain.schema, input.schema) << pipeline;
      ASSERT_TRUE(plain.records == expected->bytes) << pipeline;
      EXPECT_EQ(plain.statistics.sweeps, 0u);
      for (const Order order : {Order::input, Order::sweep}) {
        const std::string more = std::string("knn(k=6) | ") + pipeline + " | normals";
        const RunResult whole = run_text(*expected, "knn(k=6) | normals", ways_of_editing(order)[0]);
        for (const EngineOptions& options : ways_of_editing(order)) {
          const RunResult got = run_text(input, more, options);
          ASSERT_EQ(got.schema, whole.schema) << more;
          ASSERT_TRUE(got.records == whole.records) << more;
          EXPECT_EQ(got.statistics.sweeps, 1u) << "set needs no sweep of its own";
        }
        EngineOptions options = tiny(100, true, 2);
        options.order = order;
        const RunResult sorted = run_text(*expected, "where(1 < 2)", options);
        EXPECT_TRUE(run_text(input, pipeline, options).records == sorted.records) << pipeline;
      }
    }
  }
}

TEST(Set, RoundsToTheNearestWholeNumberHalvesToEven) {
  const Records input =
      with_attributes({{0.5, 0, 0}, {1.5, 0, 0}, {2.5, 0, 0}, {254.5, 0, 0}, {3.49999, 0, 0}, {-0.5, 0, 0}});
  EXPECT_EQ(run_text(input, "set(classification = x)", tiny(100)).field("classification"),
            (std::vector<double>{0, 2, 2, 254, 3, 0}));
}

TEST(Set, NewAttributesHaveTheTypeOfLasOrTheOneAskedForOrFloat64) {
  const Records input = with_attributes({{1, 2, 3}, {4, 5, 6.25}});
  const auto type = [&](const std::string& pipeline, const std::string& name) {
    const RunResult result = run_text(input, pipeline, tiny(100));
    return name_of(result.schema.fields[index_of(result.schema, name)].type);
  };
  EXPECT_EQ(type("set(height_above = z - 3)", "height_above"), "float64");
  EXPECT_EQ(type("set(height_above = z - 3, as=float32)", "height_above"), "float32");
  EXPECT_EQ(type("set(return_number = 1)", "return_number"), "uint8");
  for (const char* name : {"synthetic", "key_point", "withheld", "overlap", "scan_direction_flag",
                           "edge_of_flight_line", "scanner_channel", "number_of_returns", "user_data"})
    EXPECT_EQ(type(fmt::format("set({} = 1)", name), name), "uint8") << name;
  EXPECT_EQ(type("set(point_source_id = 65535)", "point_source_id"), "uint16");
  EXPECT_EQ(type("set(nir = 65535)", "nir"), "uint16");
  EXPECT_EQ(type("set(wide = id where id > 9223372036854775808, as=uint64)", "wide"), "uint64");
  const RunResult some = run_text(input, "set(h = z where z > 5)", tiny(100));
  EXPECT_EQ(some.field("h"), (std::vector<double>{0, 6.25}));
  const RunResult wide = run_text(input, "set(wide = id, as=uint64)", tiny(100));
  const Field& field = wide.schema.fields[index_of(wide.schema, "wide")];
  std::uint64_t last = 0;
  std::memcpy(&last, wide.records.data() + wide.schema.stride + field.offset, 8);
  EXPECT_EQ(last, (std::uint64_t{1} << 63) + 1) << "64-bit integers are not rounded";
}

TEST(Set, RealAttributesOfTheInputGetTheTypeAskedFor) {
  const Records input = with_attributes({{0.25, 2, 3}, {1, 5, 6.25}, {0.5, 1, 2}});
  const RunResult real = run_text(input, "set(a = x) | where(1 < 2)", tiny(100));  // float64, as scanners write it
  const Records scanned{real.schema, real.records};
  const auto result = [&](const std::string& pipeline) {
    const RunResult r = run_text(scanned, pipeline, tiny(100));
    return std::pair(std::string(name_of(r.schema.fields[index_of(r.schema, "a")].type)), r.field("a"));
  };
  using Result = std::pair<std::string, std::vector<double>>;
  EXPECT_EQ(result("set(a = a * 65535, as=uint16)"), Result("uint16", {16384, 65535, 32768}));
  EXPECT_EQ(result("set(a = a * 65535, a = a / 2, as=uint16)"), Result("uint16", {8192, 32768, 16384}));
  EXPECT_EQ(result("set(a = a * 100, as=float32)"), Result("float32", {25, 100, 50}));
  EXPECT_EQ(result("set(a = 7 where x > 0.5, as=uint16)"), Result("float64", {0.25, 7, 0.5}));
  EXPECT_EQ(result("set(a = a * 2)"), Result("float64", {0.5, 2, 1}));
  EXPECT_EQ(result("set(a = a * 65535, as=uint16) | set(a = a + 0.4, as=float32)"),
            Result("uint16", {16384, 65535, 32768}));
  try {
    result("set(a = a * 65536, as=uint16)");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("row 1: a would be 65536, which is not uint16"), std::string::npos)
        << error.what();
  }
}

/// Returns the input with the values of a field in another type, at the place of the field.
Records retyped(const Records& input, const std::string& field, Type type,
                const std::function<double(std::size_t row)>& value) {
  Records result;
  for (const Field& f : input.schema.fields) result.schema.append(f.name, f.name == field ? type : f.type);
  for (std::size_t f = 0; f < result.schema.fields.size(); ++f) {
    const Field& to = result.schema.fields[f];
    const Field& from = input.schema.fields[f];
    result.bytes.resize(input.size() * result.schema.stride);
    for (std::size_t i = 0; i < input.size(); ++i) {
      std::byte* const record = result.bytes.data() + i * result.schema.stride;
      if (to.name == field)
        set_value(to, record, value(i));
      else
        std::memcpy(record + to.offset, input.bytes.data() + i * input.schema.stride + from.offset, size_of(to.type));
    }
  }
  return result;
}

TEST(Set, WholeAttributesOfTheInputGetTheTypeAskedFor) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Records input = with_attributes(make_cloud(shape, sized(200), 5));
    const auto halved = [&](std::size_t i) { return std::nearbyint(input.value(i, "intensity") / 257); };
    const auto exact = [&](std::size_t i) { return input.value(i, "intensity") / 65536; };
    const auto wide = [&](std::size_t i) { return input.value(i, "classification") * 1000 - 7; };
    const std::tuple<const char*, Records, const char*> cases[] = {
        {"set(intensity = intensity / 257, as=uint8)", retyped(input, "intensity", Type::u8, halved), "intensity"},
        {"set(intensity = intensity / 65536, as=float32)", retyped(input, "intensity", Type::f32, exact), "intensity"},
        {"set(classification = classification * 1000 - 7, as=int32)", retyped(input, "classification", Type::i32, wide),
         "classification"},
        {"set(classification = classification, as=uint8)", input, "classification"}};
    for (const auto& [pipeline, expected, field] : cases) {
      const RunResult plain = run_text(input, pipeline, tiny(300));
      ASSERT_EQ(plain.schema, expected.schema) << pipeline;
      ASSERT_TRUE(plain.records == expected.bytes) << pipeline;
      const std::string more = fmt::format("statistics({0}_mean) | set({0} = {0} where z > 0)", field);
      for (const Order order : {Order::input, Order::sweep}) {
        const RunResult whole = run_text(expected, "knn(k=6) | " + more, ways_of_editing(order)[0]);
        const EngineOptions spilled = ways_of_editing(order)[1];
        const RunResult got = run_text(input, std::string("knn(k=6) | ") + pipeline + " | " + more, spilled);
        ASSERT_EQ(got.schema, whole.schema) << more;
        ASSERT_TRUE(got.records == whole.records) << more;
      }
    }
  }
}

TEST(Set, ATypeThatIsAskedForDoesNotHoldForConditionsAndWhatStagesMade) {
  const Records input = with_attributes({{0.25, 2, 3}, {1, 5, 6.25}});
  const auto type = [&](const std::string& pipeline) {
    const RunResult r = run_text(input, pipeline, tiny(100));
    return name_of(r.schema.fields[index_of(r.schema, "classification")].type);
  };
  EXPECT_EQ(type("set(classification = 7, as=float32)"), "float32");
  EXPECT_EQ(type("set(classification = 7 where x > 0.5, as=float32)"), "uint8");
  EXPECT_EQ(type("set(classification = 7) | set(classification = 8, as=float32)"), "uint8");
  EXPECT_EQ(type("set(classification = 7, as=int16) | set(classification = 8, as=float32)"), "int16");
  EXPECT_EQ(type("drop(classification) | set(classification = 8, as=float32)"), "float32");
}

TEST(Set, AValueThatTheTypeAskedForCannotHoldIsAnErrorWithRowValueAndRemedy) {
  const Records input = with_attributes({{1, 1, 1}, {300, 1, 1}, {-1, 1, 1}, {0, 0, 0}});
  EXPECT_NE(editing_error(input, "set(intensity = x, as=uint8)")
                .find("set: row 1: intensity would be 300, which is not uint8, 0 to 255; state a type that holds it "
                      "with 'as', or limit it, as in intensity = min(max(x, LEAST), MOST)."),
            std::string::npos)
      << editing_error(input, "set(intensity = x, as=uint8)");
  EXPECT_NE(editing_error(input, "set(intensity = x / y - 1 / y, as=int8)").find("row 1: intensity would be 299"),
            std::string::npos);
  EXPECT_NE(editing_error(input, "set(intensity = y / y, as=uint8)").find("row 3: intensity would be"),
            std::string::npos);
  EXPECT_EQ(editing_error(input, "set(intensity = min(max(x, 0), 255), as=uint8)"), "");
  EXPECT_EQ(editing_error(input, "set(intensity = y / y, as=float32)"), "");
}

TEST(Set, AssignmentsComeOneAfterAnotherAndLaterStagesReadThem) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 400, 6));
  const RunResult got = run_text(
      input,
      "knn(k=7) | set(a = x + 1, b = a * 2 where classification < 5, a = b) | where(b > 2.5) | neighborhood_size",
      tiny(100));
  std::vector<double> a;
  for (std::size_t i = 0; i < input.size(); ++i) {
    const double b = input.value(i, "classification") < 5 ? (input.value(i, "x") + 1) * 2 : 0;
    if (b > 2.5) a.push_back(b);
  }
  ASSERT_GT(a.size(), 40u);
  EXPECT_EQ(got.field("a"), a);
  EXPECT_EQ(got.field("b"), a);
}

TEST(Set, EditsComponentsOfWhatIsMadeAndMovesPoints) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 500, 7));
  const RunResult plain = run_text(input, "knn(k=8) | normals", tiny(100));
  const std::vector<double> nx = plain.field("nx"), nz = plain.field("nz"), ny = plain.field("ny");
  for (const EngineOptions& options : ways_of_editing(Order::input)) {
    const RunResult got = run_text(input, "knn(k=8) | normals | set(nz = -nz where nx < 0, z = z * 2 - 1)", options);
    EXPECT_EQ(got.field("nx"), nx);
    EXPECT_EQ(got.field("ny"), ny);
    for (std::size_t i = 0; i < nx.size(); ++i) {
      ASSERT_EQ(got.field("nz")[i], nx[i] < 0 ? -nz[i] : nz[i]) << i;
      ASSERT_EQ(got.field("z")[i], input.value(i, "z") * 2 - 1) << i;
    }
    EXPECT_EQ(got.field("x"), plain.field("x"));
  }
}

TEST(Set, AValueThatTheTypeCannotHoldIsAnErrorThatNamesTheRow) {
  const Records input = with_attributes({{1, 1, 1}, {300, 1, 1}, {-1, 1, 1}, {0, 0, 0}});
  EXPECT_NE(editing_error(input, "set(classification = x where x > 2)")
                .find("set: row 1: classification would be 300, which is not uint8, 0 to 255; exclude such points"),
            std::string::npos)
      << editing_error(input, "set(classification = x where x > 2)");
  EXPECT_NE(editing_error(input, "set(intensity = x where x < 2)").find("row 2: intensity would be -1"),
            std::string::npos);
  EXPECT_NE(editing_error(input, "set(intensity = 1 / x - 1 / x where x == 0)").find("row 3: intensity would be"),
            std::string::npos);
  EXPECT_NE(editing_error(input, "set(id = 18446744073709551616)").find("row 0: id would be"), std::string::npos);
  EXPECT_NE(editing_error(input, "set(gain = 1e39)").find("row 0: gain would be 1e+39, which is not float32"),
            std::string::npos);
  EXPECT_NE(editing_error(input, "set(z = 1 / x)").find("row 3: z would be inf, which is not a finite coordinate"),
            std::string::npos);
  EXPECT_EQ(editing_error(input, "set(gain = 1 / x)"), "");
  EXPECT_EQ(editing_error(input, "set(classification = 255.4999)"), "");
}

TEST(Set, TellsWhatIsWrong) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string sentence = refusal([&] { run_text(input, text, tiny(100)); });
    EXPECT_NE(sentence.find(words), std::string::npos) << text << "\n" << sentence;
  };
  expect("set(classification)", "'classification' assigns nothing; write NAME = EXPRESSION");
  expect("set(classification == 7)", "assigns nothing");
  expect("set(classification = )", "a number is missing");
  expect("set(classification = 7 where )", "the condition is empty");
  expect("set(classification = 7 where 3)", "a comparison is expected");
  expect("set(classification = z > 2)", "an attribute or a number is expected, not a comparison");
  expect("set(classification = clas)", "there is no attribute 'clas'; there are x, y, z, classification");
  expect("set", "the option 'assign' is missing; write set(");
  expect("set(a = 1, as=float)", "as is int8, uint8");
  expect("normals | set(normal = 1)", "'normal' has several components; name one of them");
  expect("set(a = 1, )", "an assignment such as classification = 7 is expected");
  expect("set(a = 1e400)", "1e400 is outside of the range of float64");
  expect("where(z Höhe > 5)", "is expected, not 'H'");
  expect("where(z ö > 5)", "is expected, not 'ö'");
  expect("normals(ö)", "is expected, not 'ö'");
}

TEST(Set, NamesTheRangeOfATypeToItsLastDigit) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  for (const auto& [text, words] :
       {std::pair{"set(a = 18446744073709551616, as=uint64)", "uint64, 0 to 18446744073709551615;"},
        {"set(a = 9223372036854775808, as=int64)", "int64, -9223372036854775808 to 9223372036854775807;"},
        {"set(a = 0 / 0, as=uint8)", "a would be nan, which is not uint8, 0 to 255;"}})
    EXPECT_NE(editing_error(input, text).find(words), std::string::npos) << editing_error(input, text);
}

TEST(Set, IsTheSameInTextJsonAndItsCanonicalForm) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 300, 4));
  const auto records = [&](const std::string& pipeline) { return run_text(input, pipeline, tiny(100)).records; };
  const auto expected = records("set(classification = 7 where z > 0.5, a = x * (y + 1) - -z, as=float32)");
  EXPECT_EQ(records("set('classification=7 where z>0.5,a=x*(y+1)- -z', as=float32)"), expected);
  const std::string text =
      R"json([{"type": "set", "assign": "classification = 7 where z > 0.5, a = x*(y+1) - -z", "as": "float32"}])json";
  EXPECT_EQ(records(text), expected);
  const std::string list =
      R"json([{"type": "set", "assign": ["classification = 7 where z > 0.5", "a = x*(y+1) - -z"], "as": "float32"}])json";
  EXPECT_EQ(records(list), expected);
  EXPECT_EQ(records("set(assign='classification = 7 where z > 0.5, a = x*(y+1) - -z', as=float32)"), expected);
  EXPECT_EQ(records("set(classification = 7 where z > 0.5, a = max(x, y) where z in (0, 1) or z between 0 and 1)"),
            records(R"json([{"type": "set", "assign": ["classification = 7 where z > 0.5",
                                                      "a = max(x, y) where z == 0 || z >= 0 && z <= 1"]}])json"));
  EXPECT_EQ(options_of(operators::set("b=min(c,2) where c in(2,3),d = 1", {})),
            (Options{{"assign", "b = min(c, 2) where c in (2, 3), d = 1"}}));
  EXPECT_EQ(options_of(operators::set("b=1 where c<2,d = - e", {})),
            (Options{{"assign", "b = 1 where c < 2, d = -e"}}));
  EXPECT_EQ(options_of(operators::set("`a, (b`=`c = d` where`e`<2, `f`=`where`", {})),
            (Options{{"assign", "`a, (b` = `c = d` where e < 2, f = `where`"}}));
}

std::vector<std::string> names_in(const Schema& schema) {
  std::vector<std::string> names;
  for (const Field& field : schema.fields) names.push_back(field.name);
  return names;
}

using FieldNames = std::vector<std::string>;

TEST(Drop, LeavesAttributesOutInEveryOrder) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[13].second, 600, 8));  // some points are not finite
  for (const Order order : {Order::input, Order::sweep}) {
    for (const EngineOptions& options : ways_of_editing(order)) {
      const auto as_kept = [&](const std::string& pipeline, const std::string& plain, const FieldNames& keep) {
        const RunResult got = run_text(input, pipeline, options), expected = run_text(input, plain, options, keep);
        EXPECT_EQ(got.schema, expected.schema) << pipeline;
        EXPECT_TRUE(got.records == expected.records) << pipeline;
      };
      as_kept("drop(intensity, id)", "where(1 < 2)", {"classification", "gain"});
      as_kept("drop(gain) | normals", "normals", {"classification", "intensity", "id", "normal"});
      as_kept("normals | curvature | drop([normal, k2, classification, intensity, gain, id]) | drop(rms_curvature)",
              "normals | curvature",
              {"k1", "k1_direction", "mean_curvature", "gaussian_curvature", "absolute_curvature", "surface_variation",
               "normal_eigenvalues", "x"});
    }
  }
}

TEST(Drop, WhatIsDroppedIsNotComputedAndMayBeMadeAgain) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 300, 9));
  const RunResult none = run_text(input, "normals | drop(normal)", tiny(100));
  EXPECT_EQ(none.schema, input.schema);
  EXPECT_TRUE(none.records == input.bytes);
  EXPECT_EQ(none.statistics.sweeps, 0u);
  const RunResult again =
      run_text(input, "normals | drop(normal, classification) | set(classification = 3) | normals", tiny(100));
  EXPECT_EQ(names_in(again.schema),
            (FieldNames{"x", "y", "z", "intensity", "gain", "id", "classification", "nx", "ny", "nz"}));
  EXPECT_EQ(run_text(input, "drop(gain)", tiny(100), {"intensity"}).schema.fields.size(), 4u);
}

TEST(Drop, LaterStagesDoNotSeeWhatIsDropped) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 300, 10));
  const auto refused = [&](const std::string& text) { return refusal([&] { run_text(input, text, tiny(100)); }); };
  const auto expect = [&](const std::string& text, const std::string& words) {
    EXPECT_NE(refused(text).find(words), std::string::npos) << text << "\n" << refused(text);
  };
  expect("drop(intensity) | where(intensity > 3)",
         "there is no attribute 'intensity'; there are x, y, z, classification, gain, id, row. Dropped before: "
         "intensity.");
  expect("drop(gain) | set(a = gain)", "Dropped before: gain.");
  expect("normals | drop(normal) | curvature",
         "curvature: needs 'normal', which was dropped before; put drop after 'curvature'");
  expect("normals | drop(nx)", "drop: 'nx' is a part of 'normal', which is made; name 'normal' as a whole");
  expect("drop(intensty)", "'intensty' cannot be dropped (did you mean 'intensity'?); the input has x, y, z,");
  expect("drop(z)", "x, y and z are always written; leave out 'z'");
  expect("drop(gain) | drop(gain)", "'gain' cannot be dropped");
  expect("drop", "the option 'attributes' is missing; write drop(intensity)");
  EXPECT_NE(refusal([&] { run_text(input, "drop(gain)", tiny(100), {"gain"}); }).find("'gain' cannot be kept"),
            std::string::npos);
  const RunResult before = run_text(input, "where(intensity > 30000) | drop(intensity)", tiny(100));
  EXPECT_EQ(before.statistics.points_written,
            run_text(input, "where(intensity > 30000)", tiny(100)).statistics.points_written);
}

}  // namespace
}  // namespace pointsweep
