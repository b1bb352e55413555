// SPDX-License-Identifier: MIT
/// Runs over every broken or odd file of $POINTSWEEP_DATA/malformed: each gives a whole output or one error sentence.
#include <set>

#include "pointsweep/formats/format.h"
#include "pointsweep/program/quantities.h"
#include "tests/cli/tool.h"
#include "tests/support/data_folder.h"
#include "tests/support/sanitizers.h"

namespace pointsweep {
namespace {

struct Outcome {
  const char* file;
  std::uint64_t points;            ///< number of points of the output
  const char* sentence = nullptr;  ///< part of the error sentence; null if the run succeeds
};

constexpr Outcome kOutcomes[] = {
    {"assimp/models/PLY/cube.ply", 8},
    {"assimp/models/PLY/cube_binary.ply", 8},
    {"assimp/models/PLY/cube_binary_header_with_RN_newline.ply", 8},
    {"assimp/models/PLY/cube_uv.ply", 24},
    {"assimp/models/PLY/float-color.ply", 3},
    {"assimp/models/PLY/issue623.ply", 0,
     "property 'vertex_indices' gives each vertex a list, which a point cannot hold"},
    {"assimp/models/PLY/points.ply", 4},
    {"assimp/models/invalid/empty.obj", 0, "is empty (0 bytes)"},
    {"assimp/models/invalid/empty.off", 0, "is empty (0 bytes)"},
    {"assimp/models/invalid/empty.ply", 0, "is empty (0 bytes)"},
    {"assimp/models/invalid/malformed.obj", 8},
    {"assimp/models/invalid/malformed2.obj", 8},
    {"assimp/models/invalid/readme.txt", 0, "line 2 is neither numbers nor a header that names x, y and z"},
    {"bunny_variants/bun000.ply", 40256},
    {"cgal_edge/blobby.xyz", 3288},
    {"cgal_edge/cube.pwn", 50000},
    {"copc-validator/bad-ellipsoid.copc.laz", 0,
     "the points should begin at byte 113098735 (byte 96), but the file ends at byte 2133333"},
    {"happly/platonic_shelf_ascii.ply", 50},
    {"happly/platonic_shelf_big_endian.ply", 50},
    {"ign_pdal-tools/test_data_0436_6384_LA93_IGN69_single_point.laz", 1},
    {"ign_pdal-tools/test_noepsg_043500_629205_IGN69.laz", 17845},
    {"ign_pdal-tools/test_pdalfail_0643_6319_LA93_IGN69.laz", 89},
    {"las-rs/32-1-472-150-76.laz", 5658},
    {"lasR/malformed_extrabytes.las", 10},
    {"laspy/append-bug.laz", 37805},
    {"laspy/unregistered_extra_bytes.las", 4},
    {"lasvalidate/README.txt", 0, "line 1 is neither numbers nor a header that names x, y and z"},
    {"lasvalidate/las12.las", 8144},
    {"lasvalidate/las12_bounding_box.las", 8144},
    {"lasvalidate/las12_creation_date.las", 8144},
    {"lasvalidate/las12_global_encoding.las", 8144},
    {"lasvalidate/las12_header_size.las", 0,
     "a header of 226 bytes (byte 94) is too short for LAS 1.2, which takes 227"},
    {"lasvalidate/las12_number_of_points_by_return.las", 8144},
    {"lasvalidate/las12_point_data_format.las", 0, "point format 14 (byte 104) is not defined"},
    {"lasvalidate/validate.xml", 0, "is an XML file"},
    {"laz-perf/no-points-1.3.las", 0, "has no points"},
    {"laz-perf/point10-1.0.las", 1},
    {"laz-perf/point10-1.0.laz", 1},
    {"laz-perf/point10-1.1.las", 1},
    {"laz-perf/point10-1.1.laz", 1},
    {"libE57Format/InvalidCVHeader.e57", 0, "has no points"},
    {"libE57Format/ZeroPoints.e57", 0, "has no points"},
    {"libE57Format/empty.e57", 0, "has no points"},
    {"libLAS/certainty3d-color-utm-feet-navd88.las", 10126},
    {"pcl/octants.pcd", 8},
    {"pdal/ept/bad-pointcount/laszip/ept-data/0-0-0-0.laz", 1065},
    {"pdal/las/1.2-with-color-clipped.las", 0, "is truncated"},
    {"pdal/las/bad-geotiff-keys.las", 10},
    {"pdal/las/bad_vlr_count.las", 10},
    {"pdal/las/hextest.las", 8},
    {"pdal/las/no-points.las", 0, "has no points"},
    {"pdal/las/synthetic_test.las", 1},
    {"pdal/las/vlr-43.bin", 0, "line 1 is neither numbers nor a header that names x, y and z"},
    {"pdal/laszip/laszip-generated_with2bytespadding.laz", 1065},
    {"pdal/pcd/missingheader.pcd", 10},
    {"pdal/pcd/utm17_space.pcd", 10},
    {"pdal/pcd/utm17_tab.pcd", 10},
    {"pdal/ply/mesh.ply", 4},
    {"pdal/ply/mesh_fixed.ply", 4},
    {"pdal/ply/no_vertex.ply", 0, "has no element 'vertex' and so no points (elements found: none)"},
    {"pdal/ply/simple_binary.ply", 3},
    {"pdal/ply/simple_text.ply", 3},
    {"pdal/ply/sized_dims.ply", 0, "its points have no z"},
    {"pdal/ply/text_extradim.ply", 1},
    {"pdal/text/badheader.txt", 0, "line 1 is neither numbers nor a header that names x, y and z"},
    {"pdal/text/crlf_test.txt", 10},
    {"pdal/text/crlf_test2.txt", 10},
    {"pdal/text/duplicates-sorted.txt", 7},
    {"pdal/text/numeric_dim.txt", 5},
    {"pdal/text/quoted.txt", 9},
    {"pdal/text/quoted2.txt", 9},
    {"point-cloud-utils/bunny_duplicates.ply", 2895},
};

/// A limit of 400,000 KB of memory, because no count of a header may be believed. The shadow memory of a sanitizer is
/// larger than any limit.
const std::string limited = has_sanitizer() ? "exec timeout 60" : "ulimit -v 400000 && exec timeout 60";

class MalformedFiles : public Tool {
 protected:
  MalformedFiles() : data_(data_folder() / "malformed") {}

  /// Runs over the file, and expects its error sentence, or an output with all its points and attributes.
  void expect(const Outcome& outcome) {
    const std::string in = "'" + (data_ / outcome.file).string() + "'";
    const std::string_view name = outcome.file;
    const std::string out = name.ends_with(".las") ? "out.las" : name.ends_with(".laz") ? "out.laz" : "out.ply";
    const Result run = tool_under(limited, "normals " + in + " " + out + " --force --memory 200M --threads 1 --quiet");
    if (outcome.sentence == nullptr) {
      EXPECT_EQ(run.status, 0) << run.err;
      const Result check = tool("verify " + in + " " + out + " --sample 200 --pipeline normals");
      EXPECT_TRUE(check.status == 0 || check.status == 3) << "3 where rounding decides\n" << check.out << check.err;
      EXPECT_NE(check.out.find("points             " + grouped_text(outcome.points) + "\n"), std::string::npos)
          << check.out;
      return;
    }
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_TRUE(run.err.starts_with("error: ")) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_NE(run.err.find(outcome.sentence), std::string::npos) << run.err;
  }

  std::filesystem::path data_;
};

TEST_F(MalformedFiles, GiveAWholeOutputOrOneSentence) {
  if (!std::filesystem::exists(data_)) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  for (Outcome outcome : kOutcomes) {
    SCOPED_TRACE(outcome.file);
    const bool laz = std::string_view(outcome.file).ends_with(".laz");
    if (laz && !has_codecs() && outcome.sentence == nullptr) outcome.sentence = "is compressed (LAZ)";
    const bool e57 = std::string_view(outcome.file).ends_with(".e57");
    if (e57 && !has_codecs()) outcome.sentence = "is an E57 file, and this pointsweep was built without";
    expect(outcome);
    EXPECT_LE(std::distance(std::filesystem::directory_iterator(folder_), {}), 5) << "hidden files were left";
  }
}

TEST_F(MalformedFiles, AreAllInTheTable) {
  if (!std::filesystem::exists(data_)) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  std::set<std::string> named;
  for (const Outcome& outcome : kOutcomes) named.insert(outcome.file);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_))
    EXPECT_TRUE(!entry.is_regular_file() || named.contains(entry.path().lexically_relative(data_).string()))
        << entry.path();
}

}  // namespace
}  // namespace pointsweep
