// SPDX-License-Identifier: MIT
/// The operator transform against plain loops in extended precision.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <random>

#include "pointsweep/operators.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

using Numbers = std::vector<double>;

constexpr const char* kTurn = "[0.8,-0.6,0,500000,0.6,0.8,0,5000000,0,0,1,-12.5]";
const Numbers kTurnNumbers = {0.8, -0.6, 0, 500000, 0.6, 0.8, 0, 5000000, 0, 0, 1, -12.5};

/// Returns points with unit normals of the type, an id, and the float32 fields `more` with values 1, 2, 3, ...
Records with_normals(const std::vector<Vec3>& points, Type type, const std::vector<std::string>& more = {}) {
  Records out;
  for (const char* axis : {"x", "y", "z"}) out.schema.append(axis, Type::f64);
  for (const char* axis : {"NormalX", "NormalY", "NormalZ"}) out.schema.append(axis, type);
  out.schema.append("id", Type::u32);
  for (const std::string& name : more) out.schema.append(name, Type::f32);
  out.bytes.resize(points.size() * out.schema.stride);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 v{normal(random), normal(random), normal(random)}, n = i % 9 == 0 ? Vec3{} : 1 / length(v) * v;
    Numbers values = {points[i].x, points[i].y, points[i].z, n.x, n.y, n.z, double(i)};
    for (std::size_t m = 0; m < more.size(); ++m) values.push_back(double(1 + m));
    for (std::size_t f = 0; f < values.size(); ++f)
      set_value(out.schema.fields[f], out.bytes.data() + i * out.schema.stride, values[f]);
  }
  return out;
}

/// Returns the sentence of the Error that `work` throws; empty if it throws none.
template <class Work>
std::string sentence_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

Vec3 normal_of(const Records& records, std::size_t row) {
  return {records.value(row, "nx"), records.value(row, "ny"), records.value(row, "nz")};
}

bool same_number(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)); }

TEST(Transform, MovesPlacesAndTurnsNormalsAndNothingElse) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Records input = with_normals(make_cloud(shape, sized(500), 61), Type::f32, {"gain", "k2"});
    for (const EngineOptions& options : ways_to_run(Order::input)) {
      const Records out = records_of(run_text(input, fmt::format("transform({})", kTurn), options));
      ASSERT_EQ(out.schema, input.schema);
      for (std::size_t i = 0; i < input.size(); ++i) {
        const Vec3 p = input.position(i), q = out.position(i), n = normal_of(input, i), turned = normal_of(out, i);
        for (std::size_t a = 0; a < 3; ++a) {
          const double* row = &kTurnNumbers[4 * a];
          const double moved = ((row[0] * p.x + row[1] * p.y) + row[2] * p.z) + row[3];
          const int axis = static_cast<int>(a);
          ASSERT_TRUE(same_number(q[axis], is_finite(p) ? moved : p[axis])) << i;
          ASSERT_NEAR(turned[axis], row[0] * n.x + row[1] * n.y + row[2] * n.z, 1e-7) << i;
        }
        for (const char* same : {"id", "gain", "k2"}) ASSERT_EQ(out.value(i, same), input.value(i, same));
      }
    }
  }
}

TEST(Transform, TheInverseTakesFarPointsBackToRounding) {
  std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 2000, 62);
  for (Vec3& p : points) p = p + Vec3{5e5, 5e6, 100};
  const Records input = with_normals(points, Type::f32);
  for (const char* options : {"[0.8,-0.6,0,500000,0.6,0.8,0,-5000000,0,0,1,-12.5]", "[0,0,2,5,1,0,0,6,0,3,0.5,7]",
                              "[1,0,0,0,0,1,0,0,0,0,1,0], scale=0.3048, translate=[-500000,-5000000,0]"}) {
    const std::string there = fmt::format("transform({})", options),
                      back = fmt::format("transform({}, inverse=yes)", options);
    const Records out = records_of(run_text(input, there + " | " + back, tiny(300)));
    for (std::size_t i = 0; i < input.size(); ++i) {
      ASSERT_LT(length(out.position(i) - input.position(i)), 2e-8) << options;
      ASSERT_LT(length(normal_of(out, i) - normal_of(input, i)), 1e-6) << options;
    }
  }
}

TEST(Transform, NormalsOfATurnedCloudAreTheTurnedNormals) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 1500, 63);
  for (const char* matrix : {kTurn, "[0,0,-1,0,0,1,0,0,1,0,0,0]", "[1,0.5,0,3,0,1,-0.2,4,0.1,0,0.7,5]"}) {
    const std::string stage = fmt::format("transform({})", matrix);
    const bool shears = std::string(matrix).find("0.5") != std::string::npos;
    std::vector<Vec3> flat = points;
    for (Vec3& p : flat) p.z = 0.3 * p.x - 0.2 * p.y;  // a plane stays a plane under a shear
    const Records input = with_normals(shears ? flat : points, Type::f32);
    const Records before = records_of(run_text(input, "knn(k=9) | normals | " + stage, tiny(300)));
    const Records after = records_of(run_text(input, "knn(k=9) | " + stage + " | normals", tiny(300)));
    for (std::size_t i = 0; i < input.size(); ++i)
      ASSERT_NEAR(std::abs(dot(normal_of(before, i), normal_of(after, i))), length(normal_of(after, i)), 1e-4) << i;
  }
}

TEST(Transform, AMirrorKeepsTheSideOfNormalsAndOnlyATranslationTheirBytes) {
  const Records input = with_normals({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, Type::f64);
  const Records mirrored = records_of(run_text(input, "transform([1,0,0,0,0,1,0,0,0,0,-1,0])", {}));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(mirrored.position(i).z, -input.position(i).z);
    EXPECT_NEAR(normal_of(mirrored, i).z, -normal_of(input, i).z, 1e-7);
    EXPECT_NEAR(normal_of(mirrored, i).x, normal_of(input, i).x, 1e-7);
  }
  const Records moved = records_of(run_text(input, "transform(translate=[1,2,3])", {}));
  EXPECT_EQ(moved.schema, input.schema) << "normals are float64 still";
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(normal_of(moved, i), normal_of(input, i));
}

TEST(Transform, ScalesLengthsByTheirPowerAndRefusesToShearThem) {
  const std::vector<std::string> names = {"mean_distance",  "k1",           "surface_density",
                                          "volume_density", "omnivariance", "splat_ratio"};
  const Records input = with_normals({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, Type::f32, names);
  const Records out = records_of(run_text(input, "transform(scale=2)", {}));
  EXPECT_EQ(out.value(1, "mean_distance"), 1 * 2.0);
  EXPECT_EQ(out.value(1, "k1"), 2 / 2.0);
  EXPECT_EQ(out.value(1, "surface_density"), 3 / 4.0);
  EXPECT_EQ(out.value(1, "volume_density"), 4 / 8.0);
  EXPECT_EQ(out.value(1, "omnivariance"), 5 * 4.0);
  EXPECT_EQ(out.value(1, "splat_ratio"), 6);
  const Records nearly = records_of(run_text(input, "transform(scale=1.0000005)", {}));
  EXPECT_EQ(nearly.value(1, "mean_distance"), 1);
  EXPECT_EQ(nearly.position(1).x, 4 * 1.0000005);
  const std::string shear = "transform([1,0.1,0,0,0,1,0,0,0,0,1,0])";
  EXPECT_NE(
      sentence_of([&] { run_text(input, shear, {}); }).find("so that 'k1', a length, has no value after it; drop it"),
      std::string::npos);
  EXPECT_EQ(sentence_of([&] {
              run_text(input, "drop(mean_distance, k1, surface_density, volume_density, omnivariance) | " + shear, {});
            }),
            "");
  EXPECT_NE(sentence_of([&] {
              run_text(input, "knn(k=1) | sor | drop(k1) | " + shear, {});
            }).find("'mean_distance', a length"),
            std::string::npos);
}

TEST(Transform, ADirectionOfWhichAPartWasAssignedIsRefused) {
  const Records input = with_normals({{1, 2, 3}, {4, 5, 6}}, Type::f32);
  const std::string sentence =
      sentence_of([&] { run_text(input, fmt::format("set(nz = 1) | transform({})", kTurn), {}); });
  EXPECT_NE(
      sentence.find("was assigned on its own, so 'normal' cannot turn as a whole; put the assignment after transform"),
      std::string::npos)
      << sentence;
  EXPECT_EQ(sentence_of([&] { run_text(input, "set(nz = 1) | transform(translate=[1,0,0])", {}); }), "");
}

TEST(Transform, APlaceThatIsFiniteStaysSoOrNamesItsRow) {
  const Records input = with_normals({{1, 2, 3}, {NAN, 1e150, 0}, {0, 1e150, 0}, {0, 1e150, 0}}, Type::f32);
  const std::string sentence =
      sentence_of([&] { run_text(input, "transform(scale=1e100) | transform(scale=1e100)", {}); });
  EXPECT_NE(sentence.find("row 2: (0, 1e+250, 0) would move to (0, inf, 0), which is not finite"), std::string::npos)
      << sentence;
}

TEST(Transform, ReadsFilesOfNumbersAndRecordsTheNumbers) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "m.txt").string();
  for (const char* text : {"0.8 -0.6 0 5\n0.6 0.8 0 6\n0 0 1 7\n0 0 0 1\n",
                           "# from a registration\n+0.8,-6e-1, 0,5;\r\n0.6\t0.8 0 6\n 0 0 1 7",
                           "[[0.8, -0.6, 0, 5],\n [0.6, 0.8, 0, 6],\n [0, 0, 1, 7],\n [0, 0, 0, 1]]"}) {
    std::ofstream(file) << text;
    const Chain chain = chain_of_any_cloud(fmt::format("transform(\"{}\", inverse=yes)", file));
    EXPECT_EQ(canonical_text(chain.stages.front(), Presets::left_out),
              "transform([0.8,-0.6,0,5,0.6,0.8,0,6,0,0,1,7], inverse=yes)");
    EXPECT_EQ(sentence_of([&] { chain_of_any_cloud(canonical_text(chain.stages.front(), Presets::left_out)); }), "");
  }
}

TEST(Transform, RefusesWhatIsNoMatrixWithTheLineAndWhatToDo) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "m.txt").string();
  const std::pair<const char*, const char*> wrong[] = {
      {"1 0 0 0\n0 1 0 0\n0 0 one 0\n", "m.txt:3: 'one' is no finite number; a matrix is 4 rows of 4 numbers"},
      {"1 0 0 0\n0 1 nan 0\n", "m.txt:2: 'nan' is no finite number"},
      {"1 0 0\n0 1 0\n0 0 1\n", "m.txt: there are 9 numbers; a matrix is 4 rows of 4 numbers, or its first 3 rows"},
      {"", "m.txt: there are 0 numbers"},
      {"1 0 0 5\n0 1 0 0\n0 0 1 0\n0 0 0.1 1\n",
       "m.txt:4: the last row is 0 0 0.1 1, not 0 0 0 1, so the matrix is a projection"},
      {"1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n",
       "m.txt:4: the last row is 5 6 7 1, not 0 0 0 1 (if the matrix is written by columns, transpose it)"},
      {"1 2 3 0\n2 4 6 0\n0 0 1 0\n", "the matrix is singular"},
      {"0 0 0 0\n0 1 0 0\n0 0 1 0\n", "the matrix is singular"},
      {"1 1 1 0\n1 1 1.0000000000001 0\n0 1 0 0\n", "the matrix is singular"}};
  for (const auto& [text, words] : wrong) {
    std::ofstream(file) << text;
    const std::string sentence = sentence_of([&] { chain_of_any_cloud(fmt::format("transform(\"{}\")", file)); });
    EXPECT_NE(sentence.find(words), std::string::npos) << text << "\n" << sentence;
  }
  const auto refused = [](const std::string& pipeline) { return sentence_of([&] { chain_of_any_cloud(pipeline); }); };
  EXPECT_NE(refused("transform([1,2,3])").find("transform: there are 3 numbers; a matrix is"), std::string::npos);
  EXPECT_NE(refused("transform(absent.txt)").find("absent.txt: cannot be opened; give a file with a matrix"),
            std::string::npos);
  EXPECT_NE(refused("transform").find("nothing says where the points go; give matrix=FILE"), std::string::npos);
  EXPECT_NE(refused("transform(inverse=yes)").find("nothing says where the points go"), std::string::npos);
  EXPECT_NE(refused("transform(scale=-1)").find("scale is a number, above 0, not '-1'"), std::string::npos);
  EXPECT_EQ(refused("transform([1e-9,0,0,0,0,1e-9,0,0,0,0,1e-9,0])"), "") << "small is not singular";
}

}  // namespace
}  // namespace pointsweep
