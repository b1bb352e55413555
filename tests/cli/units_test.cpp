// SPDX-License-Identifier: MIT
/// Clouds whose coordinate reference systems have units other than metres.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "pointsweep/program/declaration.h"
#include "pointsweep/program/pipeline.h"
#include "tests/cli/tool.h"
#include "tests/formats/las_decode.h"

namespace pointsweep {
namespace {

constexpr std::uint16_t kModel = 1024, kGeodetic = 2048, kProjected = 3072, kLinearUnit = 3076;
constexpr std::uint16_t kFoot = 9002, kMetre = 9001;

std::string keys_vlr(std::vector<std::pair<std::uint16_t, std::uint16_t>> keys) {
  std::vector<std::uint16_t> words = {1, 1, 0, static_cast<std::uint16_t>(keys.size())};
  for (const auto& [key, value] : keys) words.insert(words.end(), {key, 0, 1, value});
  return las_test::vlr("LASF_Projection", 34735, {reinterpret_cast<const char*>(words.data()), 2 * words.size()});
}

class Units : public Tool {
 protected:
  /// Writes level ground of 30 x 30 points, 1 m apart, with a house 6 m high, in units of `metres` metres.
  void write_las(const std::string& name, const std::string& vlr, double metres) {
    las_test::File file;
    file.format = 1, file.minor = 2, file.count = 900;
    file.scale = {0.001, 0.001, 0.001}, file.offset = {0, 0, 0};
    file.vlrs = {vlr};
    std::string bytes = file.bytes();
    bytes[6] = bytes[7] = 0;
    for (std::size_t i = 0; i < file.count; ++i) {
      const double x = static_cast<double>(i % 30), y = static_cast<double>(i / 30);
      const bool roof = x > 10 && x < 20 && y > 10 && y < 20;
      const double place[] = {x, y, roof ? 6.0 : 0.1 * std::sin(x + 2 * y)};
      const std::size_t at = file.points_at() + i * file.record_length();
      for (std::size_t a = 0; a < 3; ++a)
        las_test::put(bytes, at + 4 * a, static_cast<std::int32_t>(std::lround(place[a] / metres / 0.001)));
      bytes[at + 14] = 0x09;  // the only return
      bytes[at + 15] = 0;     // never classified
    }
    for (std::size_t a = 0; a < 3; ++a) {
      las_test::put(bytes, 179 + 16 * a, 31 / metres);
      las_test::put(bytes, 187 + 16 * a, -1 / metres);
    }
    write(name, bytes);
  }
  std::string classes(const std::string& file) {
    const std::string bytes = contents(folder_ / file);
    const std::size_t points = las_test::get<std::uint32_t>(bytes, 96);
    const std::size_t length = las_test::get<std::uint16_t>(bytes, 105);
    std::string classes;
    for (std::size_t at = points + 15; at < bytes.size(); at += length) classes += (bytes[at] & 31) == 2 ? 'g' : '.';
    return classes;
  }
  void write_feet() {
    write_las("feet.las", keys_vlr({{kModel, 1}, {kProjected, 2994}, {kLinearUnit, kFoot}}), 0.3048);
  }
  void write_degrees() { write_las("degrees.las", keys_vlr({{kModel, 2}, {kGeodetic, 4326}}), 1); }
};

TEST_F(Units, DefaultsThatAreLengthsAreThoseOfMetresInFeet) {
  write_las("metres.las", keys_vlr({{kModel, 1}, {kProjected, 26910}, {kLinearUnit, kMetre}}), 1);
  write_feet();
  EXPECT_EQ(tool("ground metres.las m.las").err.find("converted"), std::string::npos);
  const Result run = tool("ground feet.las f.las");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("note: ground: the unit of the cloud is ft, so these defaults are converted: cell=3.281 (1 "
                         "m), "
                         "window=59.06 (18 m), threshold=1.64 (0.5 m), scalar=4.101 (1.25 m)."),
            std::string::npos)
      << run.err;
  EXPECT_EQ(classes("f.las"), classes("m.las"));
  EXPECT_NE(classes("f.las").find('.'), std::string::npos);
  EXPECT_NE(tool("ground feet.las f.las --dry-run").out.find("note          ground: the unit of the cloud is ft"),
            std::string::npos);
}

TEST_F(Units, LengthsThatAreGivenAreInTheUnitOfTheCloud) {
  write_feet();
  const Result run = tool("ground feet.las f.las --cell 1");
  EXPECT_EQ(run.err.find("cell="), std::string::npos) << run.err;
  EXPECT_NE(tool("info f.las").out.find("ground(window=59.0"), std::string::npos);
  made("ground feet.las few.las --cell 1 --window 6");  // the time of verify grows with the cube of the window
  EXPECT_EQ(tool("verify few.las").status, 0) << "the record says cell=1 by leaving it out";
  const Result plain = tool("ground feet.las g.las --ignore-crs");
  EXPECT_EQ(plain.err.find("converted"), std::string::npos) << plain.err;
  EXPECT_EQ(tool("info g.las").out.find("window="), std::string::npos);
  EXPECT_EQ(tool("verify g.las").status, 0);
}

TEST_F(Units, NeighborsAndLengthsAreRefusedInDegrees) {
  write_degrees();
  for (const char* verb :
       {"normals degrees.las o.las", "normals degrees.las o.las --dry-run", "ground degrees.las o.las",
        "thin degrees.las o.las --voxel 0.5", "neighbors degrees.las o.npy -k 3"})
    refused(2, verb, "The coordinates are degrees of EPSG:4326, between which '");
  EXPECT_FALSE(exists("o.las"));
  made("normals degrees.las o.las --ignore-crs");
  EXPECT_EQ(tool("verify degrees.las o.las").status, 0) << tool("verify degrees.las o.las").err;
}

TEST_F(Units, StagesWithoutLengthsRunInDegrees) {
  write_degrees();
  made(
      "run degrees.las o.las --pipeline 'where(z > 3) | crop([0,0,20,20]) | unique | decimate(0.5) | "
      "set(user_data = 1)'");
  made("sort degrees.las s.las");
}

TEST_F(Units, ASystemThatDoesNotStateItsUnitIsNamedWhereDefaultsAreLengths) {
  write_las("code.las", keys_vlr({{kModel, 1}, {kProjected, 2994}}), 0.3048);
  const Result run = tool("ground code.las c.las");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("note: ground: the input does not state the unit of EPSG:2994, so it counts as the metre in "
                         "these "
                         "defaults: cell=1, window=18, threshold=0.5, scalar=1.25. Give them in feet"),
            std::string::npos)
      << run.err;
  const std::string plan = tool("ground code.las c.las --dry-run").out;
  EXPECT_NE(plan.find("note          ground: the input does not"), std::string::npos) << plan;
  for (const char* silent : {"ground code.las c.las -f --ignore-crs", "normals code.las c.las -f",
                             "ground code.las c.las -f --cell 3 --window 60 --threshold 1.6 --scalar 4"})
    EXPECT_EQ(tool(silent).err.find("does not state"), std::string::npos) << silent;
}

/// For every operator of the registry: an option whose default is a length states that the default is in metres, and
/// the default is converted.
TEST_F(Units, EveryDefaultThatIsALengthIsConverted) {
  write_feet();
  std::size_t lengths = 0;
  for (const OperatorDeclaration& declaration : all_operators()) {
    for (const OptionDeclaration& option : declaration.options) {
      const auto* metres = std::get_if<double>(&option.preset);
      if (option.unit != "length" || metres == nullptr || *metres == 0) continue;
      ++lengths;
      const Result plan = tool("run feet.las o.las --dry-run --pipeline " + declaration.name);
      EXPECT_NE(plan.out.find(fmt::format("{}={:.4g} ({:g} m)", option.name, *metres / 0.3048, *metres)),
                std::string::npos)
          << plan.out << plan.err;
    }
  }
  EXPECT_GE(lengths, 4u);
}

}  // namespace
}  // namespace pointsweep
