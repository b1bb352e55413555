// SPDX-License-Identifier: MIT
/// The warnings of a run that moves points of a cloud with a coordinate reference system.
#include "tests/cli/tool.h"
#include "tests/formats/las_test_file.h"

namespace pointsweep {
namespace {

class CoordinateSystem : public Tool {
 protected:
  CoordinateSystem() {
    las_test::File file;
    file.minor = 4;
    file.format = 6;
    file.count = 60;
    file.scale = {0.001, 0.001, 0.001};
    file.vlrs = {las_test::vlr("LASF_Projection", 2112,
                               "PROJCS[\"feet\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"s\",6378137,298]]],"
                               "UNIT[\"foot\",0.3048],AUTHORITY[\"EPSG\",\"2992\"]]")};
    std::string bytes = file.bytes();
    las_test::put(bytes, 6, std::uint16_t{16});
    write("feet.las", bytes);
    made("run feet.las plain.las --ignore-crs --pipeline 'where(1 == 1)'");
  }
  bool warns(const std::string& arguments, const std::string& words) {
    const Result result = tool(arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return (result.err + result.out).find(words) != std::string::npos;
  }
};

TEST_F(CoordinateSystem, OfPointsThatGetOtherCoordinatesIsNamedInAWarning) {
  const std::string words = " changes x, y, and the output states the coordinate system of the input, EPSG:2992";
  const std::string pipeline = " --pipeline 'set(x = x * 0.3048, y = y * 0.3048)'";
  EXPECT_TRUE(warns("run feet.las out.ply" + pipeline, "set" + words));
  EXPECT_TRUE(warns("run feet.las out2.ply --dry-run" + pipeline, "set" + words));
  std::filesystem::create_directory(folder_ / "in");
  std::filesystem::copy(folder_ / "feet.las", folder_ / "in/a.las");
  EXPECT_TRUE(warns("run in/ out/ --output-format ply" + pipeline, "set" + words));
}

TEST_F(CoordinateSystem, NeedsNoWarningWhereThePointsStayInItOrTheOutputStatesNone) {
  const std::string words = "coordinate system of the input";
  EXPECT_FALSE(warns("run feet.las a.ply --pipeline 'set(z = z + 1, intensity = 5)'", words)) << "it has no heights";
  EXPECT_FALSE(warns("run feet.las b.ply --pipeline 'knn(k=5) | normals | splats | fair'", words));
  EXPECT_FALSE(warns("run feet.las c.csv --pipeline 'set(x = x + 1)'", words));
  EXPECT_FALSE(warns("run plain.las d.ply --pipeline 'voxel(10000, keep=centroid)'", words));
}

}  // namespace
}  // namespace pointsweep
