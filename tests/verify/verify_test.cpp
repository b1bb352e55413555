// SPDX-License-Identifier: MIT
#include "pointsweep/verify/verify.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "pointsweep/chain.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/operators_of.h"

namespace pointsweep {
namespace {

MadeBy made_by(const Chain& open, const Schema& input) {
  const Chain chain = with_named_neighborhoods(open);
  return {.neighborhood = {chain.neighborhood.k, chain.neighborhood.radius},
          .rule = chain.neighborhood.rule,
          .operators = operators_of(chain.stages, input),
          .keep = chain.keep};
}

EngineOptions in_order(Order order) {
  EngineOptions options;
  options.order = order;
  return options;
}

/// A cloud with attributes in a file, runs over it, and their checks.
class Verify : public testing::Test {
 protected:
  static constexpr std::size_t kPoints = 1500;

  Verify() { write_cloud(make_cloud(hostile_shapes()[0].second, kPoints, 4)); }

  void write_cloud(const std::vector<Vec3>& points) {
    Schema schema;
    for (const char* name : {"x", "y", "z"}) schema.append(name, Type::f64);
    schema.append("intensity", Type::u16);
    schema.append("Reflectance dB", Type::f32);
    std::vector<std::byte> records(points.size() * schema.stride);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double values[] = {points[i].x, points[i].y, points[i].z, double(i % 777), 0.1 * double(i)};
      for (std::size_t f = 0; f < 5; ++f) set_value(schema.fields[f], records.data() + i * schema.stride, values[f]);
    }
    std::filesystem::remove(input());
    write_all(plan_for(input(), points.size(), schema), records);
  }

  std::filesystem::path input() const { return folder_ / "in.ply"; }

  Chain chain(const std::string& pipeline) {
    InputCloud cloud({input()});
    return build_chain(parse_pipeline(pipeline), cloud);
  }
  std::filesystem::path made(const std::string& pipeline, const std::string& name, EngineOptions options = {}) {
    InputCloud cloud({input()});
    options.overwrite = true;
    run(cloud, chain(pipeline), {.points = folder_ / name, .arrays = {}, .writer = {}}, options);
    return folder_ / name;
  }
  Verdict check(const std::string& pipeline, const std::filesystem::path& output, VerifyOptions options = {}) {
    InputCloud cloud({input()});
    const auto reader = open_reader(output);
    RowSource out(*reader);
    MadeBy made = made_by(chain(pipeline), cloud.schema());
    made.operators.clear();  // takes the operators bound to the attributes of the cloud
    for (const GraphNode& node : plan_chain(chain(pipeline), cloud.schema()).graph.nodes)
      if (node.op() != nullptr && !node.is_order() && !node.drops_rows()) made.operators.push_back(*node.op());
    return verify(cloud, out, false, made, options);
  }
  /// Changes the records of an output with `alter`, and writes the output again.
  void change(const std::filesystem::path& path,
              const std::function<void(std::vector<std::byte>& records, const Schema& schema)>& alter) {
    const auto reader = open_reader(path);
    std::vector<std::byte> records = all_records(*reader);
    const Schema schema = reader->info().schema;
    alter(records, schema);
    OutputPlan plan = plan_for(path, records.size() / schema.stride, schema);
    plan.overwrite = true;
    write_all(plan, records);
  }
  /// Expects differences, and `words` in the text of the verdict.
  static void different(const Verdict& verdict, const std::string& words) {
    EXPECT_FALSE(verdict.same());
    EXPECT_NE(to_text(verdict).find(words), std::string::npos) << to_text(verdict);
    EXPECT_TRUE(conclusion(verdict).ends_with(" wrong") || conclusion(verdict).find("differs") != std::string::npos)
        << conclusion(verdict);
  }

  TemporaryFolder folder_;
};

const char* const kPipelines[] = {"knn(k=8) | normals",
                                  "knn(k=12, radius=0.2) | normals(orient=up)",
                                  "knn(radius=0.15) | normals",
                                  "knn(k=9) | normals | curvature",
                                  "knn(k=8) | normals | curvature | splats",
                                  "knn(k=10) | normals | splats | fair | normals | splats",
                                  "knn(k=10) | normals | splats | fair(f=3, g=3) | normals | curvature",
                                  "knn(k=1) | normals",
                                  "knn(k=16, k_from=intensity) | normals | curvature",
                                  "knn(k=16, adaptive=eigenentropy, k_min=5) | normals | splats"};

TEST_F(Verify, AcceptsEveryPipelineInBothOrders) {
  for (const char* pipeline : kPipelines)
    for (const Order order : {Order::input, Order::sweep}) {
      const auto output = made(pipeline, "out.ply", in_order(order));
      VerifyOptions options{.order = order};
      const Verdict verdict = check(pipeline, output, options);
      EXPECT_TRUE(verdict.same()) << pipeline << "\n" << to_text(verdict);
      EXPECT_EQ(verdict.sampled, kPoints);
      EXPECT_TRUE(check(pipeline, output).same()) << "the order found out, " << pipeline;
    }
}

/// Each of several assignments to coordinates reads the coordinates of its point that earlier assignments have changed.
TEST_F(Verify, DecidesEveryValueOfPointsThatWereMovedSeveralTimes) {
  for (const char* pipeline : {"set(x = x * 0.3048, y = y * 0.3048, z = z * 0.3048)",
                               "knn(k=16, k_from=intensity) | set(x = x + 1, x = x * 2, y = x - y, w = x where z > 0)",
                               "knn(k=8) | normals | set(x = x + nx, y = y + ny) | set(z = z + nz)"}) {
    const Verdict verdict = check(pipeline, made(pipeline, "out.ply"));
    EXPECT_TRUE(verdict.same()) << pipeline << "\n" << to_text(verdict);
    EXPECT_EQ(verdict.open_values, 0u) << pipeline << "\n" << to_text(verdict);
    EXPECT_EQ(verdict.sampled, kPoints);
  }
}

TEST_F(Verify, AcceptsWhatIsMadeOfNeighborsThatWereMovedSeveralTimes) {
  for (const char* pipeline : {"knn(k=8) | set(z = 0.5 * z, x = x + intensity) | normals",
                               "knn(k=8) | set(x = -x, y = 2 * y) | normals | curvature"}) {
    const Verdict verdict = check(pipeline, made(pipeline, "out.ply"));
    EXPECT_TRUE(verdict.same()) << pipeline << "\n" << to_text(verdict);
    EXPECT_LT(verdict.open_values, verdict.values / 100) << to_text(verdict);
  }
}

TEST_F(Verify, AcceptsEveryFormatWithItsRounding) {
  for (const char* name : {"out.ply", "out.las", "out.xyz", "out.csv", "out.pts"})
    for (const char* pipeline : {kPipelines[0], kPipelines[5]}) {
      const Verdict verdict = check(pipeline, made(pipeline, name));
      EXPECT_TRUE(verdict.same()) << name << ", " << pipeline << "\n" << to_text(verdict);
      EXPECT_EQ(verdict.arrivals.missing.size(), 0u);
    }
}

TEST_F(Verify, AcceptsEveryHostileCloud) {
  for (const auto& [name, shape] : hostile_shapes()) {
    write_cloud(make_cloud(shape, 700, 8));
    for (const char* pipeline : {"knn(k=8) | normals", "knn(k=6) | normals | curvature"}) {
      const Verdict verdict = check(pipeline, made(pipeline, "out.ply"));
      EXPECT_TRUE(verdict.same()) << name << "\n" << to_text(verdict);
      EXPECT_EQ(verdict.sampled, 700u);
      const auto sorted = made(pipeline, "sorted.ply", in_order(Order::sweep));
      EXPECT_TRUE(check(pipeline, sorted, {.order = Order::sweep}).same()) << name;
    }
  }
}

TEST_F(Verify, AcceptsFewerPointsThanNeighbors) {
  for (const std::size_t points : {1u, 2u, 8u, 9u}) {
    write_cloud(make_cloud(hostile_shapes()[1].second, points, 8));
    const Verdict verdict = check("knn(k=8) | normals", made("knn(k=8) | normals", "out.ply"));
    EXPECT_TRUE(verdict.same()) << points << "\n" << to_text(verdict);
    EXPECT_EQ(verdict.sampled, points);
  }
}

TEST_F(Verify, LittleMemoryMeansMoreTurnsAndTheSameVerdict) {
  const auto output = made(kPipelines[5], "out.ply");
  const Verdict once = check(kPipelines[5], output, {.sample = 200});
  const Verdict often = check(kPipelines[5], output, {.sample = 200, .memory_bytes = 4 << 20});
  EXPECT_TRUE(once.same());
  EXPECT_TRUE(often.same());
  EXPECT_EQ(often.sampled, 200u);
  EXPECT_GT(often.passes, once.passes);
}

TEST_F(Verify, AnyPointIsChosenBySomeSeed) {
  const auto output = made(kPipelines[0], "out.ply");
  change(output, [](auto& records, const Schema& schema) {
    set_value(schema.fields[*schema.find("nz")], records.data() + 77 * schema.stride, 0.5);
  });
  int found = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    found += !check(kPipelines[0], output, {.sample = kPoints / 4, .seed = seed}).same();
  EXPECT_GT(found, 0);
  EXPECT_LT(found, 20);
}

TEST_F(Verify, OneNormalThatIsOffByATenThousandthOfADegreeIsFound) {
  for (const Order order : {Order::input, Order::sweep}) {
    const auto output = made(kPipelines[0], "out.ply", in_order(order));
    change(output, [](auto& records, const Schema& schema) {
      const Field& ny = schema.fields[*schema.find("ny")];
      set_value(ny, &records[1234 * schema.stride], value_of(ny, &records[1234 * schema.stride]) + 2e-6);
    });
    const Verdict verdict = check(kPipelines[0], output);
    different(verdict, "row 1234");
    EXPECT_EQ(verdict.difference_count, 1u);
    EXPECT_EQ(verdict.wrong_points, 1u);
  }
}

TEST_F(Verify, WhatIsExactIsFoundByItsLastBit) {
  const char* const pipeline = "knn(k=9, radius=0.3) | neighborhood_size";
  for (const char* field : {"neighbor_count", "neighbor_radius", "intensity", "x"}) {
    const auto output = made(pipeline, "out.ply");
    change(output, [&](auto& records, const Schema& schema) {
      records[1234 * schema.stride + schema.fields[*schema.find(field)].offset] ^= std::byte{1};
    });
    different(check(pipeline, output), fmt::format("row 1234: {} is", field));
  }
}

/// One value of every computed attribute of a chain is changed by a thousandth of itself, plus 1e-6.
TEST_F(Verify, EveryAttributeThatIsOffIsFound) {
  for (const char* pipeline : {"knn(k=12) | normals | curvature | splats", "knn(k=10) | normals | splats | fair"}) {
    const Chain written = chain(pipeline);
    for (const ChainStage& stage : written.stages)
      for (const Attribute& a : contract_of(stage).makes)
        for (const std::string& name : a.fields) {
          const auto output = made(pipeline, "out.ply");
          change(output, [&](auto& records, const Schema& schema) {
            const Field& field = schema.fields[*schema.find(name)];
            std::byte* record = &records[77 * schema.stride];
            set_value(field, record, value_of(field, record) * (1 + 1e-3) + 1e-6);
          });
          different(check(pipeline, output), "row 77");
        }
  }
}

TEST_F(Verify, AMissingPointIsFound) {
  for (const Order order : {Order::input, Order::sweep}) {
    const auto output = made(kPipelines[0], "out.ply", in_order(order));
    change(output, [](auto& records, const Schema& schema) {
      records.erase(records.begin() + 500 * schema.stride, records.begin() + 501 * schema.stride);
    });
    const Verdict verdict = check(kPipelines[0], output);
    different(verdict, "1499 points came out of 1500");
    if (order == Order::input) different(verdict, "row 500 is the first that is not the same");
  }
}

TEST_F(Verify, APointInAnothersPlaceIsFound) {
  for (const Order order : {Order::input, Order::sweep}) {
    const auto output = made(kPipelines[0], "out.ply", in_order(order));
    change(output, [](auto& records, const Schema& schema) {
      std::memcpy(&records[500 * schema.stride], &records[501 * schema.stride], schema.stride);
    });
    different(check(kPipelines[0], output), order == Order::input ? "row 500: x is" : "the values of x are not");
  }
}

TEST_F(Verify, ValuesSwappedBetweenPointsOrAttributesAreFound) {
  for (const Order order : {Order::input, Order::sweep}) {
    const auto output = made(kPipelines[0], "out.ply", in_order(order));
    change(output, [](auto& records, const Schema& schema) {
      const Field& f = schema.fields[*schema.find("intensity")];
      std::byte *a = &records[3 * schema.stride + f.offset], *b = &records[900 * schema.stride + f.offset];
      std::swap_ranges(a, a + 2, b);
    });
    different(check(kPipelines[0], output),
              order == Order::input ? "row 3: intensity is" : "not all with the points they belong to");
  }
  const auto output = made(kPipelines[0], "out.ply");
  change(output, [](auto& records, const Schema& schema) {
    for (std::size_t at = 0; at < records.size(); at += schema.stride) {
      std::byte *x = &records[at + schema.fields[0].offset], *y = &records[at + schema.fields[1].offset];
      std::swap_ranges(x, x + 8, y);
    }
  });
  different(check(kPipelines[0], output), "1500 such rows");
}

TEST_F(Verify, RowsInNoOrderAreFound) {
  const auto output = made(kPipelines[0], "out.ply");
  change(output, [](auto& records, const Schema& schema) {
    std::swap_ranges(records.begin(), records.begin() + schema.stride, records.begin() + 700 * schema.stride);
  });
  different(check(kPipelines[0], output), "ascend neither");
}

TEST_F(Verify, PointsThatAreNotFiniteStandBehindAllOthersInASweep) {
  std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, kPoints, 4);
  points[40].y = std::numeric_limits<double>::quiet_NaN();
  write_cloud(points);
  const auto output = made(kPipelines[0], "out.ply", in_order(Order::sweep));
  EXPECT_TRUE(check(kPipelines[0], output).same());
  change(output, [](auto& records, const Schema& schema) {
    std::rotate(records.begin(), records.end() - schema.stride, records.end());
  });
  different(check(kPipelines[0], output), "ascend neither");
}

TEST_F(Verify, AMissingAttributeIsFoundAndAnUnknownOneNamed) {
  made("normals", "out.ply");
  different(check("normals | curvature", folder_ / "out.ply"), "has no 'k1'");
  const Verdict verdict = check("normals", made("normals | splats", "out.ply"));
  EXPECT_TRUE(verdict.same());
  EXPECT_NE(to_text(verdict).find("not checked        splat_x"), std::string::npos) << to_text(verdict);
}

TEST_F(Verify, AnotherNeighborhoodThanTheOneNamedIsFound) {
  different(check("knn(k=9) | normals", made("knn(k=8) | normals", "out.ply")), "by brute force");
  different(check("knn(k=16) | normals", made("knn(k=16, k_from=intensity) | normals", "out.ply")), "by brute force");
  different(check("knn(k=8) | normals(orient=up)", made("knn(k=8) | normals", "out.ply")), "by brute force");
}

TEST_F(Verify, AFairedPointThatIsWrongIsFound) {
  const auto output = made(kPipelines[5], "out.ply");
  change(output, [](auto& records, const Schema& schema) {
    const Field& z = schema.fields[2];
    set_value(z, &records[42 * schema.stride], value_of(z, &records[42 * schema.stride]) + 1e-7);
  });
  different(check(kPipelines[5], output), "row 42: z is");
}

TEST_F(Verify, AttributesOfTheFileReachTheOperators) {
  made("normals(orient=up)", "up.ply");
  std::filesystem::rename(folder_ / "up.ply", input());
  for (const char* pipeline : {"normals(orient=input)", "curvature"}) {
    const Verdict verdict = check(pipeline, made(pipeline, "out.ply"));
    EXPECT_TRUE(verdict.same()) << pipeline << "\n" << to_text(verdict);
  }
  const auto output = made("curvature", "out.ply");
  change(output, [](auto& records, const Schema& schema) {
    set_value(schema.fields[*schema.find("nx")], records.data() + 9 * schema.stride, 0.25);
  });
  different(check("curvature", output), "row 9: nx is 0.25");
}

/// Reads an attribute of the library, and makes an attribute for which the library has no formula.
class Steepness final : public LocalOperator {
 public:
  std::string name() const override { return "steepness"; }
  Contract contract() const override {
    return {{normal_attribute()}, {normal_attribute()}, {scalar("steepness", Type::f32, "1", "of its own")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) {
      float sum = in.value<std::array<float, 3>>(0, i)[2];
      for (std::size_t j = 0; j < in.count(i); ++j) sum += in.neighbor_value<std::array<float, 3>>(0, i, j)[2];
      out.column<float>(0)[i] = sum;
    }
  }
};

TEST_F(Verify, OperatorsOfUsersAreAppliedAgainAndNamedAsNotIndependent) {
  Chain written = chain("knn(k=9) | normals");
  written.stages.push_back(std::make_shared<Steepness>());
  InputCloud cloud({input()});
  run(cloud, written, {.points = folder_ / "out.ply", .arrays = {}, .writer = {}});
  const auto checked = [&] {
    const auto reader = open_reader(folder_ / "out.ply");
    RowSource out(*reader);
    return verify(cloud, out, false, made_by(written, cloud.schema()));
  };
  EXPECT_TRUE(checked().same()) << to_text(checked());
  EXPECT_EQ(checked().by_own_operator, std::vector<std::string>{"steepness"});
  EXPECT_NE(to_text(checked()).find("not independent    steepness\n"), std::string::npos) << to_text(checked());
  change(folder_ / "out.ply", [](auto& records, const Schema& schema) {
    records[99 * schema.stride + schema.fields[*schema.find("steepness")].offset] ^= std::byte{1};
  });
  different(checked(), "row 99: steepness is");
}

/// An operator of a user with the name of an operator of the library and without options.
class OwnRor final : public LocalOperator {
 public:
  std::string name() const override { return "ror"; }
  Contract contract() const override { return {.makes = {scalar("rare", Type::f32, "1", "of its own")}}; }
  void apply(const Neighborhoods&, Columns&) const override {}
};

TEST_F(Verify, AnOperatorOfAUserThatHasTheNameOfAnotherIsRefused) {
  InputCloud cloud({input()});
  const Chain written{{.k = 8}, {std::make_shared<OwnRor>()}};
  run(cloud, written, {.points = folder_ / "out.ply", .arrays = {}, .writer = {}});
  try {
    const auto reader = open_reader(folder_ / "out.ply");
    RowSource out(*reader);
    verify(cloud, out, false, made_by(written, cloud.schema()));
    FAIL();
  } catch (const UsageError& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("'ror' has no option 'radius'"), std::string::npos) << refusal.what();
  }
}

TEST_F(Verify, NeighborsAndDistancesAreCheckedToTheLastOne) {
  InputCloud cloud({input()});
  const Chain graph{{.k = 6}, {std::make_shared<NeighborRows>(6, kPoints, true)}};
  run(cloud, graph,
      {.points = {}, .arrays = {{"neighbors", folder_ / "n.npy"}, {"distances", folder_ / "d.npy"}}, .writer = {}});
  const auto checked = [&](const char* name) {
    MadeBy made = made_by(graph, cloud.schema());
    made.keep = {name[0] == 'n' ? "neighbors" : "distances"};
    const auto array = open_npy(folder_ / name);
    RowSource out(*array);
    return verify(cloud, out, true, made);
  };
  EXPECT_TRUE(checked("n.npy").same()) << to_text(checked("n.npy"));
  EXPECT_TRUE(checked("d.npy").same()) << to_text(checked("d.npy"));
  std::string bytes = contents(folder_ / "n.npy");
  char* const row = bytes.data() + bytes.size() - 100 * 6 * 4;
  std::swap_ranges(row, row + 4, row + 4);  // swaps the nearest two neighbours of a point
  folder_.write("n.npy", bytes);
  different(checked("n.npy"), "row 1400: neighbor_0 is");
}

}  // namespace
}  // namespace pointsweep
