// SPDX-License-Identifier: MIT
/// The operator color against a plain loop: least and greatest value, then the colour map.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/pipeline/engine_run.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

using Channels = std::array<double, 3>;

std::vector<Channels> colors_in(const RunResult& result) {
  const auto red = result.field("red"), green = result.field("green"), blue = result.field("blue");
  std::vector<Channels> colors;
  for (std::size_t i = 0; i < red.size(); ++i) colors.push_back({red[i], green[i], blue[i]});
  return colors;
}

/// Returns the grey levels 255 t, rounded half up, times `brightest`.
std::vector<Channels> gray_of(const Records& input, const std::string& field, double lo, double hi, double brightest) {
  std::vector<Channels> colors;
  for (std::size_t i = 0; i < input.size(); ++i) {
    const double v = input.value(i, field);
    const double t = hi > lo ? std::min(1.0, std::max(0.0, (v - lo) / (hi - lo))) : 0;
    const double level = std::isnan(v) ? 128 : std::floor(255 * t + 0.5);
    colors.push_back({level * brightest, level * brightest, level * brightest});
  }
  return colors;
}

TEST(Color, SpansTheLeastAndGreatestValueOfTheCloud) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Records input = with_attributes(make_cloud(shape, sized(900), 3));
    for (const std::string by : {"gain", "intensity", "z", "id"}) {
      double lo = std::numeric_limits<double>::infinity(), hi = -lo;
      for (std::size_t i = 0; i < input.size(); ++i)
        if (const double v = input.value(i, by); std::isfinite(v)) lo = std::min(lo, v), hi = std::max(hi, v);
      const std::vector<Channels> expected = gray_of(input, by, lo, hi, 1);
      std::string first;
      for (EngineOptions options : {tiny(100, false, 1), tiny(100, true, 2), tiny(50'000, false, 3)}) {
        const RunResult got = run_text(input, "color(" + by + ", map=gray)", options);
        ASSERT_EQ(colors_in(got), expected) << by;
        EXPECT_EQ(got.statistics.sweeps, 0u);
        EXPECT_EQ(colors_in(run_text(input, "knn(k=5) | normals | color(by=" + by + ", map=gray)", options)), expected);
      }
    }
  }
}

TEST(Color, AGivenRangeIsKeptAndMapsDiffer) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 500, 4));
  EXPECT_EQ(colors_in(run_text(input, "color(intensity, map=gray, range=[1000,30000])", tiny(100))),
            gray_of(input, "intensity", 1000, 30000, 1));
  EXPECT_EQ(colors_in(run_text(input, "color(intensity, map=gray, range=[7,7])", tiny(100))),
            gray_of(input, "intensity", 7, 7, 1));
  const auto ends = [&](const std::string& map) {
    const Records two = with_attributes({{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}});
    return colors_in(run_text(two, "color(x, map=" + map + ")", tiny(100)));
  };
  EXPECT_EQ(ends("viridis"), (std::vector<Channels>{{68, 1, 84}, {253, 231, 37}, {35, 144, 140}}));
  // By hand from Mikhailov's polynomials: 255 times their values at 0, 1 and 1/2.
  EXPECT_EQ(ends("turbo")[0], (Channels{35, 23, 27}));
  EXPECT_EQ(ends("turbo")[1], (Channels{144, 13, 0}));
  EXPECT_EQ(ends("turbo")[2], (Channels{150, 250, 80}));
}

TEST(Color, ClassesHaveTheirColors) {
  const Records input = with_attributes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {6, 0, 0}, {64, 0, 0}, {255, 0, 0}});
  const auto colors =
      colors_in(run_text(input, "set(classification = x) | color(classification, map=classes)", tiny(100)));
  EXPECT_EQ(colors[2], (Channels{168, 112, 56})) << "ground is brown";
  EXPECT_EQ(colors[3], (Channels{225, 75, 60})) << "buildings are red";
  EXPECT_NE(colors[4], colors[5]);
}

TEST(Color, HasAsManyBitsAsTheInputOrAsAskedFor) {
  const Records input = with_attributes({{0, 0, 0}, {1, 0, 0}});
  const auto brightest = [&](const std::string& pipeline) {
    return run_text(input, pipeline, tiny(100)).field("red")[1];
  };
  EXPECT_EQ(brightest("color(x, map=gray)"), 255);
  EXPECT_EQ(brightest("color(x, map=gray, bits=16)"), 65535);
  EXPECT_EQ(brightest("set(point_source_id = 1) | color(x, map=gray)"), 255) << "the input is not LAS";
  Records las = input;
  las.schema.fields[4].name = "point_source_id";
  EXPECT_EQ(run_text(las, "color(x, map=gray)", tiny(100)).field("red")[1], 65535);
  EXPECT_EQ(run_text(las, "color(x, map=gray, bits=8)", tiny(100)).field("red")[1], 255);
}

TEST(Color, OfWhatStagesMakeAndOfRowsThatAreLeft) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, sized(600), 5));
  const Records kept = input.those([&](std::size_t i) { return input.value(i, "x") > 0.2; });
  const RunResult got = run_text(input, "where(x > 0.2) | color(y, map=turbo)", tiny(100));
  EXPECT_EQ(colors_in(got), colors_in(run_text(kept, "color(y, map=turbo)", tiny(100))));
  const RunResult normals = run_text(input, "knn(k=7) | normals", tiny(100));
  const Records made = records_of(normals);
  EXPECT_EQ(colors_in(run_text(input, "knn(k=7) | normals | color(nz)", tiny(100, true, 2))),
            colors_in(run_text(made, "color(nz)", tiny(100))));
}

TEST(Color, ColorsOfTheInputAreReplacedOnlyOnRequest) {
  const TemporaryFolder folder;
  folder.write("in.xyz", "# x y z red green blue\n0 0 0 1 2 3\n1 0 0 4 5 6\n");
  const auto run_to = [&](std::vector<std::string> replace, std::string prefix) {
    InputCloud cloud({folder / "in.xyz"});
    EngineOptions options;
    options.replace = std::move(replace), options.prefix = std::move(prefix), options.overwrite = true;
    run(cloud, build_chain(parse_pipeline("color(x)"), cloud), {.points = folder / "out.ply"}, options);
  };
  EXPECT_NE(refusal([&] {
              run_to({}, "");
            }).find("the computed 'red' would overwrite its attribute 'red'; allow it with --replace color"),
            std::string::npos)
      << refusal([&] { run_to({}, ""); });
  EXPECT_NO_THROW(run_to({"color"}, ""));
  EXPECT_NO_THROW(run_to({"red", "green", "blue"}, ""));
  EXPECT_NO_THROW(run_to({}, "by_x_"));
}

TEST(Color, TellsWhatIsWrong) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  const auto expect = [&](const std::string& text, const std::string& words) {
    const std::string sentence = refusal([&] { run_text(input, text, tiny(100)); });
    EXPECT_NE(sentence.find(words), std::string::npos) << text << "\n" << sentence;
  };
  expect("color", "the option 'by' is missing; write color(z)");
  expect("color(intensty)", "there is no attribute 'intensty'; there are x, y, z, classification");
  expect("color('x + 1')", "'x + 1' is not the name of an attribute; make one before by set(NAME = ...)");
  expect("color(x, range=[1])", "range is two numbers, [LO,HI], not 1");
  expect("color(x, range=[2,1])", "the range begins at 2 and ends at 1");
  expect("color(x, map=classes, range=[1,2])", "classes have no range");
  expect("color(x, map=jet)", "map is viridis, turbo, gray or classes, not 'jet'");
}

}  // namespace
}  // namespace pointsweep
