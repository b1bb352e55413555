// SPDX-License-Identifier: MIT
/// PCD files as outputs of runs.
#include <gmock/gmock.h>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;
using testing::Not;

class PcdOutput : public Tool {
 protected:
  std::string header_of(const std::string& name) const {
    const std::string file = contents(folder_ / name);
    return file.substr(0, file.find("DATA binary"));
  }
};

TEST_F(PcdOutput, HoldsNormalsAndColorsUnderTheNamesOfPcl) {
  write("a.xyz", "x y z red green blue\n0 0 0 1 2 3\n1 0 0 255 0 0\n0 1 0 0 0 7\n1 1 0 9 9 9\n");
  made("sort a.xyz a.ply");
  write(
      "colors.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
      "red\nproperty uchar green\nproperty uchar blue\nend_header\n0 0 0 1 2 3\n1 0 0 255 0 0\n0 1 0 0 0 7\n1 1 0 9 9 "
      "9\n");
  made("normals colors.ply out.pcd -k 3");
  EXPECT_THAT(header_of("out.pcd"), HasSubstr("FIELDS x y z rgb normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4 4\n"));
  made("sort out.pcd out.csv --axis x");
  EXPECT_THAT(contents(folder_ / "out.csv"),
              HasSubstr("x,y,z,red,green,blue,normal_x,normal_y,normal_z\n0,0,0,1,2,3,"));
}

TEST_F(PcdOutput, IsVerifiedByItsOwnRecord) {
  made("generate statue in.ply -n 20000");
  for (const char* options : {"", "--order sweep", "--memory 40M", "--prefix my_"}) {
    SCOPED_TRACE(options);
    made(std::string("normals in.ply out.pcd --force ") + options);
    EXPECT_THAT(header_of("out.pcd"), HasSubstr("# pointsweep stage normals"));
    EXPECT_THAT(made("verify out.pcd --sample 100", ".out"), HasSubstr("points             20,000\n"));
  }
}

TEST_F(PcdOutput, IsTheSameInAllWaysToRunAndResumed) {
  made("generate statue in.ply -n 40000 --double");
  const std::string run = "run in.ply out.pcd --pipeline 'normals | curvature' --force --quiet --no-provenance ";
  const std::string right = made(run, "out.pcd");
  for (const char* options : {"--memory 40M", "--threads 1", "--resume done --checkpoint-seconds 0"}) {
    SCOPED_TRACE(options);
    EXPECT_TRUE(made(run + options, "out.pcd") == right);
  }
}

TEST_F(PcdOutput, OfPcdKeepsFieldsAndViewpointAndNanPoints) {
  write("in.pcd",
        "VERSION 0.7\nFIELDS x y z rgba label\nSIZE 4 4 4 4 4\nTYPE F F F U U\nCOUNT 1 1 1 1 2\nWIDTH 2\nHEIGHT 2\n"
        "VIEWPOINT 0 0 1.5 1 0 0 0\nPOINTS 4\nDATA ascii\n0 0 0 4278190335 7 8\n1 0 0 1 9 10\nnan nan nan 0 1 2\n0 1 0 "
        "2 3 4\n");
  made("normals in.pcd out.pcd -k 3");
  EXPECT_THAT(header_of("out.pcd"),
              HasSubstr("FIELDS x y z rgba label normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4 4 4\nTYPE F F F U U F F "
                        "F\nCOUNT 1 1 1 1 2 1 1 1\nWIDTH 4\nHEIGHT 1\nVIEWPOINT 0 0 1.5 1 0 0 0\nPOINTS 4\n"));
  made("verify in.pcd out.pcd");
  const Result again = tool("normals out.pcd again.pcd -k 3");
  EXPECT_THAT(again.err, HasSubstr("replacing normal_x, normal_y, normal_z"));
  EXPECT_THAT(header_of("again.pcd"), HasSubstr("FIELDS x y z rgba label normal_x normal_y normal_z\n"));
}

TEST_F(PcdOutput, OfLasKeepsAllValuesAndSaysThatTheCoordinateSystemIsLost) {
  made("generate statue a.ply -n 3000");
  write("points.xyz", "x y z red green blue intensity\n500000.01 4e6 1 65535 256 0 9\n500001.02 4e6 2 1 2 3 10\n");
  made("sort points.xyz points.las --axis x");
  made("sort points.las out.pcd --axis x");
  EXPECT_THAT(header_of("out.pcd"), HasSubstr("FIELDS x y z "));
  EXPECT_THAT(header_of("out.pcd"), Not(HasSubstr(" rgb")));  // 16 bits do not fit into it
  made("verify points.las out.pcd --order sweep --axis x");
}

TEST_F(PcdOutput, PackedColorsAndAlphaReachOtherFormatsAsBytes) {
  write("in.pcd",
        "VERSION 0.7\nFIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n0 0 0 4278190335\n1 0 0 2130772225\n");
  made("sort in.pcd out.las --axis x");
  made("sort out.las out.csv --axis x");
  EXPECT_THAT(contents(folder_ / "out.csv"), HasSubstr("alpha"));
  EXPECT_THAT(made("info out.las", ".out"), HasSubstr("alpha uint8"));
  made("verify in.pcd out.las --order sweep --axis x");
  made("sort in.pcd out.ply --axis x");
  EXPECT_THAT(contents(folder_ / "out.ply"), HasSubstr("property uchar alpha\n"));
}

}  // namespace
}  // namespace pointsweep
