// SPDX-License-Identifier: MIT
/// `verify` of operators whose values come from all points: right outputs pass, and changed values are found.
#include <cmath>
#include <fstream>
#include <regex>

#include "pointsweep/error.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"
#include "pointsweep/verify.h"
#include "tests/cli/tool.h"
#include "tests/formats/point_files.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/radius_pipelines.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPoints = 600;

/// Points with normals and classes, and outputs whose values are changed in place, so that the record of their run
/// stays. Tests with many outputs call verify() in this process, because starting the tool takes longer.
class VerifyOperators : public Tool {
 protected:
  VerifyOperators() : started_in_(std::filesystem::current_path()) { std::filesystem::current_path(folder_); }
  ~VerifyOperators() override { std::filesystem::current_path(started_in_); }

  void write_cloud(const std::string& name, const std::vector<Vec3>& points) {
    Schema schema;
    for (const char* field : {"x", "y", "z"}) schema.append(field, Type::f64);
    for (const char* field : {"nx", "ny", "nz"}) schema.append(field, Type::f32);
    schema.append("classification", Type::u8);
    schema.append("intensity", Type::f32);
    std::vector<std::byte> records(points.size() * schema.stride);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double a = 0.7 * double(i % 9), c = i % 11 == 0 ? 0 : 1;
      const double values[] = {points[i].x,           points[i].y,           points[i].z,
                               c * std::cos(a) * 0.6, c * std::sin(a) * 0.6, c * (i % 2 == 0 ? 0.8 : -0.8),
                               double(i % 4),         0.1 * double(i)};
      for (std::size_t f = 0; f < 8; ++f) set_value(schema.fields[f], records.data() + i * schema.stride, values[f]);
    }
    std::filesystem::remove(folder_ / name);
    write_all(plan_for(folder_ / name, points.size(), schema), records);
  }
  void write_hostile(const CloudShape& shape) {
    write_cloud("in.ply", make_cloud(shape, kPoints, 4));
    write_cloud("other.ply", make_cloud(shape, kPoints / 2, 9));
  }

  void run(const std::string& pipeline, const std::string& options = "") {
    made("run in.ply out.ply --force --quiet --pipeline '" + pipeline + "' " + options);
  }
  /// Returns whether all values are checked, except for values that rounding decides.
  static bool only_rounding_is_open(const Verdict& verdict) {
    static const std::regex open("not checked: [0-9,]+ of [0-9,]+ values; all else is correct");
    return verdict.is_complete() || std::regex_match(conclusion(verdict), open);
  }
  static void same(const Verdict& verdict, const std::string& what) {
    EXPECT_TRUE(verdict.same() && only_rounding_is_open(verdict)) << what << "\n" << to_text(verdict);
    EXPECT_TRUE(verdict.by_own_operator.empty()) << what << "\n" << to_text(verdict);
  }
  /// Verifies the output against the record of its run in its header.
  static Verdict checked(const std::string& output = "out.ply") { return verify({}, output); }
  static Verdict checked(const std::vector<std::filesystem::path>& inputs, const std::string& output,
                         const std::string& pipeline) {
    return verify(inputs, output, {.pipeline = pipeline});
  }

  /// Changes a value of every `step`-th row of out.ply from row `first` on.
  void change(const std::string& field, std::size_t first, std::size_t step) {
    const auto reader = open_reader(folder_ / "out.ply");
    const Schema schema = reader->info().schema;
    std::string bytes = contents(folder_ / "out.ply");
    const std::size_t header = bytes.find("end_header\n") + 11;
    const Field at = schema.fields[schema.find(field).value()];
    for (std::size_t row = first; row < reader->info().count; row += step) {
      auto* record = reinterpret_cast<std::byte*>(bytes.data() + header + row * schema.stride);
      const double old = value_of(at, record);
      const bool is_real = at.type == Type::f32 || at.type == Type::f64;
      set_value(at, record, std::isnan(old) ? 1.0 : is_real ? 1.001 * old + 0.001 : old == 0 ? 1.0 : old - 1);
    }
    write("out.ply", bytes);
  }
  /// Expects that a changed value of `field` is found. A wrong `normal_turned` shows as a wrong normal.
  void found(const std::string& field, std::size_t first, std::size_t step, const std::string& what) {
    const std::string right = contents(folder_ / "out.ply");
    change(field, first, step);
    const Verdict changed = checked();
    EXPECT_FALSE(changed.same()) << what << ", " << field << "\n" << to_text(changed);
    const std::string difference = changed.same() ? "" : changed.differences.front();
    EXPECT_TRUE(difference.find(field + " is") != std::string::npos || field == "normal_turned") << difference;
    write("out.ply", right);
  }
  static bool is_determined() {
    const Verdict found = checked();
    return found.same() && found.is_complete();
  }

  /// Checks a pipeline on every shape in one of the two orders by turns, and on the first shape in both orders, with
  /// each field changed, and without the record of the run.
  void checks(const std::string& pipeline, const std::vector<std::string>& fields) {
    std::vector<std::string> orders = {"input", "sweep"};
    for (const auto& [name, shape] : hostile_shapes()) {
      const std::string what = name + ", " + pipeline;
      write_hostile(shape);
      const bool is_first = name == "closed surface";
      std::swap(orders[0], orders[1]);
      for (std::size_t i = 0; i < (is_first ? 2 : 1); ++i) {
        run(pipeline, "--order " + orders[i]);
        same(checked(), what + ", " + orders[i]);
        if (is_first)
          for (const std::string& field : fields) found(field, 123, kPoints, what + ", " + orders[i]);
      }
      if (fields.front() != "normal_turned" || is_determined()) found(fields.front(), 0, 4, what);
      if (!is_first) continue;
      run(pipeline, "--no-provenance");
      same(checked({"in.ply"}, "out.ply", pipeline), what);
    }
  }

 private:
  std::filesystem::path started_in_;
};

TEST_F(VerifyOperators, EveryRadiusAtTheLeastThatHoldsAPointAndNextToIt) {
  const PairAtRadius pair = pairs_at_radius().back();
  const std::string header = "x,y,z,nx,ny,nz,k1,own\n";
  write("other.csv", fmt::format("x,y,z,label\n{},{},{},1\n", pair.q.x, pair.q.y, pair.q.z));
  for (const auto& [name, text] : radius_pipelines())
    for (const double r : {PairAtRadius::below(pair.radius), pair.radius, PairAtRadius::above(pair.radius)}) {
      std::string rows;
      for (const Vec3 p : {pair.p, pair.q, pair.p + Vec3{1000, 0, 0}, pair.p + Vec3{0, 3000, 0}})
        rows += fmt::format("{},{},{},0,0,1,1,{}\n", p.x, p.y, p.z, r);
      write("in.csv", header + rows);
      const std::string pipeline = radius_pipeline(text, r, (folder_ / "other.csv").string());
      made("run in.csv out.ply -f -q --pipeline '" + pipeline + "'", "out.ply");
      try {
        const Verdict found = checked();
        EXPECT_TRUE(found.same()) << pipeline << "\n" << to_text(found);
      } catch (const UsageError& refusal) {  // for stages whose kept rows a sample does not determine
        EXPECT_NE(std::string(refusal.what()).find("verify the output of the stages before it"), std::string::npos);
      }
    }
}

TEST_F(VerifyOperators, DistancesToAnotherCloud) {
  checks("distance_to(other.ply)", {"cloud_distance"});
  checks("distance_to(other.ply, most=0.1)", {"cloud_distance"});
}

TEST_F(VerifyOperators, AttributesOfAnotherCloud) {
  checks("take(other.ply, attributes=classification)", {"classification"});
  checks("drop(nx, ny, nz, intensity) | take(other.ply, attributes=[intensity, nx], k=5, vote=mean, most=0.2)",
         {"intensity"});
  checks("normals | take(other.ply, attributes=[nz, classification], k=4, most=0.1, missing=2)", {"classification"});
}

TEST_F(VerifyOperators, ChangesAlongNormals) {
  const std::vector<std::string> fields = {"m3c2_distance", "m3c2_lod",      "m3c2_spread1",
                                           "m3c2_spread2",  "m3c2_samples1", "m3c2_samples2"};
  checks("m3c2(other.ply, cylinder=0.61, depth=0.93, registration=0.01)", fields);
  checks("knn(k=6) | normals | m3c2(other.ply, cylinder=1.3, depth=2.17)", fields);
}

TEST_F(VerifyOperators, HeightsAboveTheGround) {
  checks("height", {"height"});
  checks("height(k=5)", {"height"});
}

TEST_F(VerifyOperators, Components) {
  checks("knn(k=3) | components", {"component", "component_size"});
  checks("knn(radius=0.2) | components(distance=0.13)", {"component", "component_size"});
  checks("knn(k=9, radius=0.1) | components", {"component", "component_size"});
}

TEST_F(VerifyOperators, Clusters) {
  checks("knn(radius=0.2) | dbscan(eps=0.2, min_points=4)", {"core", "cluster", "cluster_size"});
  checks("knn(radius=0.3) | dbscan(eps=0.11, min_points=3)", {"core", "cluster", "cluster_size"});
}

TEST_F(VerifyOperators, SegmentsOfNormalsOfTheInputAndOfNormalsThatWereMade) {
  checks("knn(k=6) | segments(angle=40, distance=0.3)", {"segment", "segment_size", "segment_residual"});
  checks("knn(k=5) | normals | segments(angle=10)", {"segment", "segment_size", "segment_residual"});
}

/// The output has the normals of the input, but the segments are made from computed normals.
TEST_F(VerifyOperators, NormalsThatWereMadeAndNotWrittenAreNotThoseOfTheInput) {
  write_hostile(hostile_shapes()[0].second);
  const std::string orient = "knn(k=8) | normals | orient", segments = " | segments(angle=20)";
  for (const auto& [pipeline, keep] : {std::pair("knn(k=8) | normals" + segments, "segment_size"),
                                       std::pair(orient + segments, "segment"), std::pair(orient, "normal_turned")}) {
    run(pipeline, std::string("--keep ") + keep);
    const Result result = tool("verify out.ply");
    EXPECT_EQ(result.status, 3) << pipeline << "\n" << result.out;
    EXPECT_NE(result.out.find("what it reads is not in the output\n"), std::string::npos) << result.out;
  }
}

TEST_F(VerifyOperators, NormalsOfDoublesInText) {
  write_hostile(hostile_shapes()[0].second);
  made("run in.ply in.csv --quiet --pipeline 'where(x > -1e9)'");
  std::string text = contents(folder_ / "in.csv");
  text = std::regex_replace(text, std::regex("0\\.8,"), "0.8000000123,");
  write("in.csv", text);
  for (const std::string pipeline : {"m3c2(other.ply, cylinder=0.61, depth=0.93)", "knn(k=8) | segments(angle=20)"}) {
    made("run in.csv out.ply --force --quiet --pipeline '" + pipeline + "'");
    same(checked(), pipeline);
  }
}

TEST_F(VerifyOperators, SignsOfNormals) {
  checks("knn(k=5) | orient", {"normal_turned"});
  checks("knn(k=8) | normals | segments | orient", {"normal_turned", "nx", "segment"});
  checks("knn(radius=0.2) | normals(orient=up) | orient(viewpoint=[0.3,0.4,-5])", {"normal_turned"});
}

TEST_F(VerifyOperators, Ground) {
  checks("ground(cell=0.1, window=0.4, threshold=0.05, slope=0.3)", {"classification"});
  checks("ground(cell=0.5, window=2, noise=yes) | height(k=2)", {"height"});
}

TEST_F(VerifyOperators, LabelsOfNeighborsWhereTheMemoryDoesNotHoldAllPoints) {
  // This budget suffices for the order of the sweep, but not for a graph.
  const auto checked_within_little = [] { return verify({}, "out.ply", {.memory_bytes = 60 * 1024}); };
  std::size_t turn = 0;  // each cloud but one is checked with half of the pipelines
  for (const auto& [name, shape] : hostile_shapes()) {
    write_hostile(shape);
    ++turn;
    for (const auto& [pipeline, number] : std::vector<std::pair<std::string, std::string>>{
             {"knn(k=4) | components", "component"},
             {"knn(radius=0.3) | components(distance=0.2)", "component"},
             {"knn(radius=0.2) | dbscan(eps=0.2, min_points=4)", "cluster"},
             {"knn(k=6) | segments(angle=60)", "segment"}}) {
      if (++turn % 2 == 0 && name != "closed surface") continue;
      run(pipeline, pipeline.starts_with("knn(k") ? "--order sweep" : "");
      const Verdict right = checked_within_little();
      const std::string text = to_text(right);
      EXPECT_TRUE(right.same() && !right.is_complete()) << name << pipeline << text;
      EXPECT_NE(text.find("that they are apart and in order needs --memory"), std::string::npos) << text;
      const std::string bytes = contents(folder_ / "out.ply");
      change(number, 0, 4);
      EXPECT_FALSE(checked_within_little().same()) << name << pipeline;
      write("out.ply", bytes);
      change(number + "_size", 123, kPoints);
      EXPECT_FALSE(checked_within_little().same()) << name << pipeline;
      if (number != "segment" || name != "closed surface") continue;
      write("out.ply", bytes);
      change("segment_residual", 0, 4);
      EXPECT_FALSE(checked_within_little().same()) << name << pipeline;
    }
  }
}

TEST_F(VerifyOperators, MeansOfVoxels) {
  checks("voxel(0.3, keep=centroid)", {"x", "z", "nx", "intensity"});
  checks("where(x > -0.6) | voxel(0.05, keep=centroid)", {"y"});
}

TEST_F(VerifyOperators, SeveralInputsAndRowsThatWereLeftOut) {
  write_hostile(hostile_shapes()[0].second);
  made("run in.ply more.ply --quiet --pipeline 'where(x > 0)' --no-provenance");
  for (const std::string pipeline : {"distance_to(other.ply)", "where(z > -0.5) | height(k=2)",
                                     "where(z > -0.5) | ground(cell=0.2, window=1) | height(k=2)",
                                     "knn(k=4) | where(x > -0.8) | normals | segments(angle=30) | components | orient",
                                     "knn(k=6) | where(y > 0) | normals | m3c2(other.ply, cylinder=0.3, depth=1)"}) {
    made("run in.ply more.ply -o both.ply --force --quiet --pipeline '" + pipeline + "'");
    same(checked("both.ply"), pipeline);
    same(checked({"in.ply", "more.ply"}, "both.ply", pipeline), pipeline);
  }
}

}  // namespace
}  // namespace pointsweep
