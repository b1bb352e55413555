// SPDX-License-Identifier: MIT
/// Values and files that no run loses or changes in silence, whatever formats and options meet.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

#include "tests/cli/tool.h"
#include "tests/formats/las_decode.h"

namespace pointsweep {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class SilentLosses : public Tool {
 protected:
  /// Runs the tool, expects success, and returns what it prints on standard error.
  std::string said(const std::string& arguments) {
    const Result result = tool(arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result.err;
  }
  static las_test::File las_file(int minor, int format) {
    las_test::File file;
    file.minor = minor;
    file.format = format;
    file.count = 60;
    file.scale = {0.001, 0.001, 0.001};
    return file;
  }
  /// Returns the values of each point of a LAS file.
  std::vector<las_test::Values> points_of(const std::string& name) const {
    const las_test::Decoded file{contents(folder_ / name)};
    std::vector<las_test::Values> points;
    for (std::size_t i = 0; i < file.count(); ++i) points.push_back(file.point(i));
    return points;
  }
};

TEST_F(SilentLosses, OneReturnFieldThatIsLeftOutLeavesTheOthers) {
  write("in.csv",
        "x,y,z,return_number,number_of_returns,scan_direction_flag,edge_of_flight_line\n"
        "0,0,0,2,3,1,0\n1,0,0,3,5,0,1\n2,1,0,1,1,1,1\n");
  for (const char* format : {"1", "3", "6", "8"}) {
    made(std::string("convert in.csv in.las -f --point-format ") + format);
    const auto all = points_of("in.las");
    for (const std::string left_out :
         {"return_number", "number_of_returns", "scan_direction_flag", "edge_of_flight_line"}) {
      const std::string pipeline = "--pipeline 'drop(" + left_out + ")'";
      made("run in.las out.las -f " + pipeline);
      EXPECT_EQ(tool("verify in.las out.las " + pipeline).status, 0) << left_out;
      const auto kept = points_of("out.las");
      ASSERT_EQ(kept.size(), all.size());
      const double value = left_out.find("return") == std::string::npos ? 0 : 1;
      for (std::size_t i = 0; i < all.size(); ++i) {
        las_test::Values expected = all[i];
        expected.at(left_out) = value;
        EXPECT_EQ(kept[i], expected) << format << " " << left_out << " " << i;
      }
    }
  }
}

TEST_F(SilentLosses, ARowOfTextThatLacksACellIsAnErrorAndAnEmptyLastCellIsNot) {
  for (const char separator : {',', ';', '|'}) {
    write("in.csv", fmt::format("x{0}y{0}z\n1{0}2{0}3\n4{0}5{0}\n7{0}8{0}9\n", separator));
    made("convert in.csv out.csv -f");
    EXPECT_THAT(contents(folder_ / "out.csv"), HasSubstr("4,5,nan")) << separator;
    write("in.csv", fmt::format("x{0}y{0}z\n1{0}2{0}3\n4{0}5{0}\"\"\n7{0}8{0}9\n", separator));
    made("convert in.csv out.csv -f");
    EXPECT_THAT(contents(folder_ / "out.csv"), HasSubstr("4,5,nan")) << separator;
    write("in.csv", fmt::format("x{0}y{0}z\n1{0}2{0}3\n4{0}5\n7{0}8{0}9\n", separator));
    refused(1, "convert in.csv out.csv -f", "in.csv: line 3 has 2 values where 3 are expected");
  }
  write("in.txt", "1,2\n4,5\n");
  refused(1, "convert in.txt out.csv -f --columns x,y,z", "line 1 has 2 values where 3 are expected");
}

TEST_F(SilentLosses, ColorsOfPcdInEightBitsBecomeSixteenBitsOfLas) {
  write("in.csv", "x,y,z,red,green,blue\n0,0,0,255,128,1\n1,0,0,0,17,254\n");
  made("run in.csv in.pcd --pipeline 'set(red = red, green = green, blue = blue, as=uint8)'");
  EXPECT_THAT(said("convert in.pcd out.las"), HasSubstr("8 bits are written as 16 bits, times 257"));
  const auto points = points_of("out.las");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].at("red"), 65535);
  EXPECT_EQ(points[0].at("green"), 128 * 257);
  EXPECT_EQ(points[1].at("blue"), 254 * 257);
  EXPECT_EQ(tool("verify in.pcd out.las").status, 0);
}

TEST_F(SilentLosses, AStrayPointThatCoarsensTheGridOfLasIsAWarning) {
  std::string text = "x y z\n";
  for (int i = 0; i < 50; ++i) text += fmt::format("684{:03}.123 5017{:03}.456 {}.789\n", i, 2 * i, i);
  write("near.xyz", text);
  EXPECT_THAT(said("convert near.xyz near.las"), Not(HasSubstr("rounded")));
  write("far.xyz", text + "-1000000000 0 0\n");
  EXPECT_THAT(said("convert far.xyz far.las"),
              HasSubstr("warning: far.las: coordinates are rounded to steps of 1 in x, 0.01 in y and 0.001 in z"));
}

TEST_F(SilentLosses, WholeNumbersBeyondFloat64AreNotRoundedByArithmetic) {
  write("in.csv", "x,y,z,id\n0,0,0,9007199254740993\n1,0,0,-3\n2,0,0,4\n");
  refused(1, "run in.csv out.csv --pipeline 'set(id = id + 1)'",
          "row 0: id is computed with whole numbers beyond 2^53, which arithmetic in float64 rounds");
  refused(1, "run in.csv out.csv --pipeline 'set(near = id - 9007199254740992, as=int64)'", "row 0: near is computed");
  refused(1, "run in.csv out.csv --pipeline 'set(id = id * 9007199254740994 where x == 2)'", "row 2: id is computed");
  made("run in.csv c.csv --pipeline 'set(big = x * 9007199254740994, as=int64)'");
  made("run in.csv a.csv --pipeline 'set(id = id + 1 where x > 0)'");
  EXPECT_EQ(contents(folder_ / "a.csv"), "x,y,z,id\n0,0,0,9007199254740993\n1,0,0,-2\n2,0,0,5\n");
  made("run in.csv b.csv --pipeline 'set(copy = id, as=int64) | set(part = id / 1000, half = id / 2)'");
  EXPECT_THAT(contents(folder_ / "b.csv"), HasSubstr("0,0,0,9007199254740993,9007199254740993,"));
}

TEST_F(SilentLosses, AnOutputDoesNotReplaceTheFileToWhichAnOpenStreamGoes) {
  write("in.csv", "x,y,z\n0,0,0\n1,0,0\n2,1,0\n");
  std::filesystem::create_symlink("/dev/stderr", folder_ / "link");
  for (const std::string stream : {"/dev/stderr", "/dev/fd/2", "/proc/self/fd/2", "link"}) {
    const Result result = tool("convert in.csv out.csv -f --stats " + stream);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.err.rfind("error: " + stream + ": stands for an open stream", 0), 0u) << result.err;
  }
}

TEST_F(SilentLosses, FilesOfAnEarlierRunAmongTheTilesAreAWarning) {
  made("generate terrain all.las -n 3000");
  const std::string words = "point files that this run did not write";
  EXPECT_THAT(said("tile all.las out --size 500"), Not(HasSubstr(words)));
  EXPECT_THAT(said("tile all.las out --size 500 -f"), Not(HasSubstr(words)));
  EXPECT_THAT(said("run all.las out --tile 500 -f --pipeline 'where(x < 400)'"),
              HasSubstr(words + " (500_0.las and 1 more)"));
  EXPECT_THAT(said("run all.las out2 --tile 500 -f --pipeline 'where(x < 400)'"), Not(HasSubstr(words)));
  made("tile all.las out3 --size 500 --buffer 200");
  EXPECT_THAT(said("run all.las out3 --tile 500 --tile-buffer 200 -f --pipeline 'where(x < 400)'"),
              HasSubstr(words + " (500_0.las and 1 more)"));
  refused(2, "tile all.las 'out/*_*.las' --size 500", "one '*' stands for the name of each file");
}

TEST_F(SilentLosses, PointsInTheBuffersOfTilesAreANoteUnlessTheyAreLeftOut) {
  made("generate terrain all.las -n 3000");
  made("tile all.las tiles --size 500 --buffer 50");
  EXPECT_THAT(said("convert tiles all2.las"), HasSubstr("note: the inputs have the attribute 'buffer'"));
  EXPECT_THAT(said("run tiles all3.las --pipeline 'where(buffer == 0)'"), Not(HasSubstr("'buffer'")));
}

TEST_F(SilentLosses, HeightsInAnotherUnitThanTheMapAreANoteWhereDistancesMatter) {
  las_test::File file = las_file(4, 6);
  const std::string map = "PROJCS[\"map\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378137,298]]],UNIT[\"metre\",1]]";
  for (const std::string unit : {"UNIT[\"US survey foot\",0.304800609601219]", "UNIT[\"metre\",1]"}) {
    file.vlrs = {
        las_test::vlr("LASF_Projection", 2112,
                      "COMPD_CS[\"both\"," + map + ",VERT_CS[\"heights\",VERT_DATUM[\"d\",2005]," + unit + "]]")};
    std::string bytes = file.bytes();
    las_test::put(bytes, 6, std::uint16_t{16});
    write("in.las", bytes);
    const std::string note = said("run in.las out.las -f --pipeline 'knn(k=5) | normals'");
    const std::string words = "normals: x and y are in m, but heights in US survey ft";
    EXPECT_EQ(note.find(words) != std::string::npos, unit.find("foot") != std::string::npos) << note;
    EXPECT_THAT(said("convert in.las out.las -f"), Not(HasSubstr("heights in")));
    EXPECT_THAT(said("run in.las out.las -f --pipeline 'knn(k=5) | set(z = z * 0.3048006096012192) | normals'"),
                Not(HasSubstr("heights in")));
  }
}

TEST_F(SilentLosses, GroundWithoutAPointThatTakesPartIsAWarningAndSoAreHeightsWithoutGround) {
  write("in.csv", "x,y,z,classification,return_number,number_of_returns\n0,0,0,2,1,3\n1,2,0,2,1,3\n2,4,1,1,1,3\n");
  const std::string without = "warning: ground: no point takes part, so that none is ground";
  EXPECT_THAT(said("ground in.csv out.las --height"),
              AllOf(HasSubstr(without), HasSubstr("warning: height: no point has class 2 (ground)")));
  EXPECT_THAT(said("ground in.csv out.las -f --height --returns all"),
              AllOf(Not(HasSubstr("takes part")), Not(HasSubstr("warning: height"))));
}

TEST_F(SilentLosses, VerifyTellsOfRoundingAndOfPointsThatStagesLeaveOut) {
  write("in.csv", "X,Y,Z\n0.25,0,0\n1,2,0\n2,4,8\n");
  made("convert in.csv coarse.las --scale 4");
  made("convert coarse.las again.las");
  EXPECT_THAT(made("verify in.csv again.las", ".out"),
              AllOf(HasSubstr("rounded            X by up to 2, Y by up to 2\n"),
                    HasSubstr("OK: inputs unchanged but for rounding\n")));
  made("convert in.csv fine.las");
  EXPECT_THAT(
      made("verify in.csv fine.las", ".out"),
      AllOf(Not(HasSubstr("rounded")), HasSubstr("OK: inputs unchanged\n"), HasSubstr("points             3\n")));
  made("run in.csv part.las --pipeline 'where(y < 3)'");
  EXPECT_THAT(made("verify in.csv part.las", ".out"), HasSubstr("points             2, of 3 in the input\n"));
}

TEST_F(SilentLosses, WaveformsOfLas13AreCountedAsAnExtendedVlrInLas14) {
  const las_test::File file = las_file(3, 4);
  std::string bytes = file.bytes();
  const std::uint64_t start = bytes.size();
  las_test::put(bytes, 227, start);
  write("in.las", bytes + std::string(100, 'w'));
  made("convert in.las out.las --point-format 9 --las-version 1.4");
  const std::string out = contents(folder_ / "out.las");
  const auto waveforms = las_test::get<std::uint64_t>(out, 227);
  EXPECT_EQ(out.size(), waveforms + 100);
  EXPECT_EQ(las_test::get<std::uint64_t>(out, 235), waveforms) << "start of the first extended VLR";
  EXPECT_EQ(las_test::get<std::uint32_t>(out, 243), 1u) << "number of extended VLRs";
}

}  // namespace
}  // namespace pointsweep
