// SPDX-License-Identifier: MIT
/// The operators set and drop as a user runs them, on LAS, PLY and text, and verify of their outputs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pointsweep/verify.h"
#include "tests/cli/tool.h"
#include "tests/formats/las_decode.h"

namespace pointsweep {
namespace {

class SetStage : public Tool {
 protected:
  SetStage() {
    std::string text = "x y z intensity classification level\n";
    for (int i = 0; i < 900; ++i)
      text += fmt::format("{} {} {} {} {} {}\n", i % 30 * 0.5, i / 30 * 0.25, i * 37 % 101 * 0.25, i * 31 % 700, i % 7,
                          i * 0.125);
    write("all.txt", text);
    made("run all.txt all.las -q --pipeline 'where(1 < 2)'");
  }
  void expect_verified(const std::string& in, const std::string& out, const std::string& pipeline) {
    made(fmt::format("run {} {} -f -q --pipeline '{}'", in, out, pipeline));
    const Verdict verdict = verify({}, folder_ / out);
    EXPECT_TRUE(verdict.same() && verdict.is_complete()) << pipeline << "\n" << to_text(verdict);
    EXPECT_TRUE(verdict.by_own_operator.empty()) << pipeline << "\n" << to_text(verdict);
  }
};

TEST_F(SetStage, VerifyEvaluatesAssignmentsByItsOwnCode) {
  for (const char* in : {"all.txt", "all.las"})
    for (const char* out : {"out.ply", "out.las", "out.txt", "out.laz"}) {
      expect_verified(in, out, "set(classification = 7 where intensity > 300 && !(z < 3) || x == 2.5)");
      expect_verified(in, out,
                      "knn(k=9) | sor | normals | set(classification = 7 where outlier == 1, intensity = intensity * 2 "
                      "+ 0.5, w = nz * 2 - -3 / (x + 1) where nx > 0, as=float32)");
      expect_verified(in, out, "set(z = z * 0.5 + 1 where intensity >= 350) | drop(intensity)");
      expect_verified(in, out, "normals | drop(normal, intensity)");
      expect_verified(in, out, "drop(classification)");
      expect_verified(in, out, "color(intensity)");
      expect_verified(in, out, "where(z > 3) | color(z, map=turbo, bits=16)");
      expect_verified(in, out, "knn(k=6) | normals | color(nz, map=gray, range=[0,1])");
      expect_verified(in, out, "set(classification = 6 where z > 9) | color(classification, map=classes, bits=8)");
    }
}

TEST_F(SetStage, NaNHasNoSignInText) {
  const std::string text =
      made("run all.txt out.txt -q --pipeline 'set(n = 0/0, m = -(0/0), o = 0/0, as=float32)'", "out.txt");
  EXPECT_NE(text.find(" nan nan nan\n"), std::string::npos) << text.substr(0, 300);
  EXPECT_EQ(text.find("-nan"), std::string::npos);
}

TEST_F(SetStage, ReadsWhatAnEarlierPassMadeOfTheRowsThatASelectHasLeft) {
  for (const char* out : {"out.las", "out.ply"})
    expect_verified("all.txt", out, "knn(k=9) | normals | where(nz > 0) | set(w = nz * 2, as=float32)");
}

TEST_F(SetStage, TheIntensityOfAScannerBecomesThatOfLas) {
  std::string text = "x,y,z,intensity\n", right = "x,y,z,intensity\n";
  for (int i = 0; i <= 500; ++i) {
    text += fmt::format("{},{},{},{}\n", i % 20, i / 20, i % 7, i * 0.002);
    right += fmt::format("{},{},{},{}\n", i % 20, i / 20, i % 7, std::nearbyint(i * 0.002 * 65535));
  }
  write("scan.csv", text);
  const std::string pipeline = "set(intensity = intensity * 65535, as=uint16)";
  for (const char* out : {"out.las", "out.laz", "out.ply", "out.txt"}) {
    expect_verified("scan.csv", out, pipeline);
    EXPECT_EQ(tool(std::string("info ") + out).out.find("intensity_float64"), std::string::npos) << out;
    made(std::string("convert ") + out + " rows.csv -q -f --keep x,y,z,intensity");
    EXPECT_EQ(contents(folder_ / "rows.csv"), right) << out;
  }
  const std::string las = contents(folder_ / "out.las");
  for (const char* options : {"--threads 1", "--threads 7 --memory 40M", "--resume kept"}) {
    made(fmt::format("run scan.csv out.las -f -q {} --pipeline '{}'", options, pipeline));
    EXPECT_TRUE(contents(folder_ / "out.las") == las) << options;
  }
  refused(1, "run scan.csv o.las --pipeline 'set(intensity = intensity * 65600, as=uint16)'",
          "row 500: intensity would");
}

TEST_F(SetStage, ColorsOfSixteenBitsBecomeThoseOfEightForFormatsThatHoldThem) {
  std::string text = "x y z red green blue\n", right = "x,y,z,red,green,blue\n";
  for (int i = 0; i < 600; ++i) {
    const std::array<int, 3> color = {i * 113 % 65536, i * 7919 % 65536, 65535 - i * 109 % 65536};
    text += fmt::format("{} {} {} {} {} {}\n", i % 20, i / 20, i % 7, color[0], color[1], color[2]);
    right += fmt::format("{},{},{}", i % 20, i / 20, i % 7);
    for (const int c : color) right += fmt::format(",{}", std::nearbyint(c / 257.0));
    right += '\n';
  }
  write("wide.txt", text);
  made("convert wide.txt wide.las -q");
  made("convert wide.txt wide.laz -q");
  const std::string pipeline = "set(red = red / 257, green = green / 257, blue = blue / 257, as=uint8)";
  for (const char* in : {"wide.las", "wide.laz", "wide.txt"})
    for (const char* out : {"out.ply", "out.pcd", "out.txt", "out.las"}) {
      expect_verified(in, out, pipeline);
      if (std::string(out) == "out.las") continue;  // 16 bits again, times 257
      made(fmt::format("convert {} rows.csv -q -f --keep x,y,z,red,green,blue", out));
      EXPECT_EQ(contents(folder_ / "rows.csv"), right) << in << " " << out;
    }
  made("run wide.laz out.ply -f -q --pipeline '" + pipeline + "'");
  const std::string ply = contents(folder_ / "out.ply");
  EXPECT_NE(ply.find("property uchar red\n"), std::string::npos);
  for (const char* options : {"--threads 1", "--threads 7 --memory 40M", "--resume kept", "--order input"}) {
    made(fmt::format("run wide.laz out.ply -f -q {} --pipeline '{}'", options, pipeline));
    EXPECT_TRUE(contents(folder_ / "out.ply") == ply) << options;
  }
  made("run wide.las near.ply -f -q --order sweep --pipeline '" + pipeline + "'");
  EXPECT_EQ(tool("verify near.ply").status, 0);
  refused(1, "run wide.laz o.ply --pipeline 'set(red = red / 256, as=uint8)'",
          "row 579: red would be 255.57421875, which is not uint8, 0 to 255; state a type that holds it");
}

TEST_F(SetStage, VerifyFindsAWrongAssignment) {
  made("run all.txt out.txt -f -q --pipeline 'set(level = level * 2 where intensity < 300)'");
  const std::string other = "verify all.txt out.txt --pipeline 'set(level = ";
  EXPECT_EQ(tool(other + "level * 2 where intensity < 300)'").status, 0);
  for (const char* wrong :
       {"level * 2 where intensity <= 300)'", "level * 2)'", "level + level * 1.0001 where intensity < 300)'",
        "level * 2 where !(intensity < 300))'", "level * 2 where intensity < 300 && z > 0)'"})
    EXPECT_EQ(tool(other + wrong + " --sample 900").status, 1) << wrong;
}

TEST_F(SetStage, VerifyFindsAWrongColor) {
  made("run all.txt out.ply -f -q --pipeline 'color(intensity, map=turbo, range=[0,700])'");
  for (const char* wrong :
       {"map=viridis, range=[0,700]", "map=turbo, range=[0,690]", "map=turbo", "map=gray, range=[0,700]"})
    EXPECT_EQ(tool(fmt::format("verify all.txt out.ply --pipeline 'color(intensity, {})'", wrong)).status, 1) << wrong;
}

TEST_F(SetStage, StandardNamesStayFieldsOfLas) {
  made(
      "run all.las out.las -q --pipeline 'set(classification = 9, intensity = 65535, user_data = 3 where x > 3) | "
      "drop(level)'");
  const std::string info = tool("info out.las").out;
  EXPECT_NE(info.find("classification"), std::string::npos) << info;
  EXPECT_EQ(info.find("level", info.find("ranges")), std::string::npos) << info;
  made(
      "run out.las text.txt -q --no-provenance --keep classification,intensity,user_data --pipeline 'where(x <= 3.5)'");
  std::string text = contents(folder_ / "text.txt");
  EXPECT_NE(text.find(" 65535 "), std::string::npos) << text.substr(0, 200);
  refused(1, "run all.las bad.las --pipeline 'set(classification = 256)'",
          "row 0: classification would be 256, which is not uint8");
  EXPECT_FALSE(exists("bad.las"));
}

/// Other programs have other names for the fields of LAS files.
TEST_F(SetStage, NamesMayBeThoseOfOtherPrograms) {
  const std::string keep = " -f -q --no-provenance --pipeline ";
  const std::string own =
      made("run all.las own.txt" + keep + "'where(classification == 3 && return_number == 1)'", "own.txt");
  EXPECT_EQ(made("run all.las pdal.txt" + keep + "'where(Classification == 3 && ReturnNumber == 1)'", "pdal.txt"), own);
  EXPECT_EQ(made("run all.las e.txt" + keep + "'where(class == 3 && scalar_ReturnNumber == 1)'", "e.txt"), own);
  made("run all.las set.las" + keep + "'set(ReturnNumber = 2 where i > 300, NumberOfReturns = 3)'");
  const std::string info = tool("info set.las").out;
  EXPECT_NE(info.find("number_of_returns"), std::string::npos) << info;
  EXPECT_EQ(info.find("ReturnNumber"), std::string::npos) << "an attribute of the input is assigned, none is added";
  const std::string verify = "verify all.las set.las --pipeline ";
  EXPECT_EQ(tool(verify + "'set(ReturnNumber = 2 where i > 300, NumberOfReturns = 3)'").status, 0);
  EXPECT_EQ(tool(verify + "'set(ReturnNumber = 1 where i > 300, NumberOfReturns = 3)'").status, 1);
}

TEST_F(SetStage, TilesAndTheMergedCloudGetTheSameValues) {
  std::filesystem::create_directory(folder_ / "tiles");
  const std::string text = contents(folder_ / "all.txt");
  const std::size_t middle = text.find('\n', text.size() / 2) + 1;
  write("tiles/a.txt", text.substr(0, middle));
  write("tiles/b.txt", text.substr(0, text.find('\n') + 1) + text.substr(middle));
  const std::string options =
      " -f -q --no-provenance --pipeline 'knn(k=6) | sor | set(intensity = 5 where outlier == 1, a = z) | "
      "drop(mean_distance)'";
  made("run tiles -o out/" + options);
  const std::string whole = made("run all.txt -o whole.txt" + options, "whole.txt");
  const std::string second = contents(folder_ / "out/b.txt");
  EXPECT_EQ(contents(folder_ / "out/a.txt") + second.substr(second.find('\n') + 1), whole);
}

}  // namespace
}  // namespace pointsweep
