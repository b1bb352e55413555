// SPDX-License-Identifier: MIT
/// The stage orient(method=trajectory) from the command line.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <sstream>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;

class OrientByTrajectory : public Tool {
 protected:
  static constexpr const char* kPipeline = "'knn(k=8) | normals | orient(method=trajectory, trajectory=flight.csv)' ";

  /// Writes two walls, at x = 0 and x = 10, measured from between them at times that grow with y.
  void SetUp() override {
    std::string points = "x y z gps_time\n";
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 10; ++j)
        for (const int x : {0, 10}) points += fmt::format("{} {} {} {}\n", x, 0.5 * i, 0.5 * j, 1000 + 0.5 * i);
    write("walls.xyz", points);
    write("flight.csv", "time,x,y,z\n1000,5,0,2\n1010,5,10,2\n1020,5,20,2\n");
  }
};

TEST_F(OrientByTrajectory, NormalsFaceTheSensorAtTheTimeOfThePoint) {
  const std::string right = made(std::string("run walls.xyz out.csv --force --pipeline ") + kPipeline, "out.csv");
  std::istringstream lines(right);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,gps_time,nx,ny,nz");
  std::size_t points = 0;
  for (char comma; std::getline(lines, line); ++points) {
    double x, y, z, time, nx;
    std::istringstream(line) >> x >> comma >> y >> comma >> z >> comma >> time >> comma >> nx;
    EXPECT_EQ(nx, x == 0 ? 1 : -1) << line;
  }
  EXPECT_EQ(points, 800u);
  for (const char* options : {"--threads 1", "--memory 60M", "--axis x", "--resume done --checkpoint-seconds 0"})
    EXPECT_EQ(made(std::string("run walls.xyz out.csv --force --pipeline ") + kPipeline + options, "out.csv"), right);
}

TEST_F(OrientByTrajectory, OutputsKnowTheContentOfTheTrajectory) {
  made(std::string("run walls.xyz out.ply --pipeline ") + kPipeline);
  EXPECT_THAT(contents(folder_ / "out.ply").substr(0, 2000), HasSubstr("checksum"));
  made("verify walls.xyz out.ply");
  write("flight.csv", "1000 5 0 2\n1020 5 20 3\n");
  EXPECT_THAT(tool("verify out.ply").err, HasSubstr("flight.csv: is not the trajectory"));
}

TEST_F(OrientByTrajectory, SaysWhatIsWrong) {
  const auto pipeline = [](const std::string& options) {
    return "run walls.xyz no.ply --pipeline 'knn(k=8) | normals | orient(" + options + ")'";
  };
  refused(1, pipeline("method=trajectory, trajectory=gone.csv"), "gone.csv: cannot be opened");
  refused(2, pipeline("method=trajectory"), "needs trajectory=FILE");
  refused(2, pipeline("trajectory=flight.csv"), "needs method=trajectory");
  refused(2, "run walls.xyz no.ply --pipeline 'orient(method=trajectory, trajectory=flight.csv)'", "normal");
  write("flight.csv", "5 1 2 3\n6 1 2 3\n");
  refused(1, pipeline("method=trajectory, trajectory=flight.csv"), "a trajectory from 5 to 6");
  write("bare.xyz", "x y z\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
  const Result bare =
      tool("run bare.xyz no.ply --pipeline 'knn(k=3) | normals | orient(method=trajectory, trajectory=flight.csv)'");
  EXPECT_NE(bare.status, 0);
  EXPECT_THAT(bare.err, HasSubstr("gps_time"));
  EXPECT_FALSE(exists("no.ply"));
}

}  // namespace
}  // namespace pointsweep
