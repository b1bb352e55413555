// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "pointsweep/error.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

using ::testing::HasSubstr;

TEST(Registry, TellsFormatsByContentNotByName) {
  const TemporaryFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n1 2 3\n";
  EXPECT_EQ(open_reader(folder.write("points.las", ply))->info().format, "PLY 1.0 ascii");
  EXPECT_EQ(open_reader(folder.write("points.ply", "1 2 3\n"))->info().format, "text, space separated, without header");
  EXPECT_EQ(open_reader(folder.write("points", "x;y;z\n1;2;3\n"))->info().format,
            "text, semicolon separated, with header");
}

TEST(Registry, SaysWhatAFileIsThatItDoesNotRead) {
  using namespace std::string_literals;
  const TemporaryFolder folder;
  const auto sentence_for = [&](const std::string& name, const std::string& content) {
    const auto path = folder.write(name, content);
    return sentence_of<Error>([&] { open_reader(path); });
  };
  EXPECT_THAT(sentence_for("a", "glTF\2\0"s), HasSubstr("a: is a glTF file, which pointsweep does not read"));
  EXPECT_THAT(sentence_for("a", "\x1f\x8b\x08\0"s), HasSubstr("is a gzip archive"));
  EXPECT_THAT(sentence_for("a", "solid s\nfacet\n"), HasSubstr("is an STL file"));
  EXPECT_THAT(sentence_for("a.PTX", "15\n1\n"), HasSubstr("is a PTX file that does not begin"));
  EXPECT_THAT(sentence_for("a", "<VTKFile type=\"PolyData\">\n"), HasSubstr("is a VTK XML file"));
  EXPECT_THAT(sentence_for("a", "\xff\xfex\0"s), HasSubstr("UTF-16"));
  EXPECT_THAT(sentence_for("a", "12 34\0"s), HasSubstr("is binary (byte 5 is 0)"));
  EXPECT_THAT(sentence_for("a", ""), HasSubstr("is empty"));
  EXPECT_THAT(sentence_of<Error>([&] { open_reader(folder / "b"); }), HasSubstr("no such file"));
  EXPECT_THAT(sentence_of<Error>([&] { open_reader(folder.path()); }), HasSubstr("is a folder"));
}

TEST(Registry, RefusesExtensionsItCannotWrite) {
  EXPECT_THAT(sentence_of<UsageError>([] { create_writer(plan_for("out.vtk", 0)); }),
              HasSubstr("cannot write .vtk; use .ply, .las"));
  EXPECT_THAT(sentence_of<UsageError>([] { create_writer(plan_for("out", 0)); }),
              HasSubstr("a file without an extension"));
}

/// A real file, and the number of its points, or a part of the sentence with which it is refused.
struct RealFile {
  const char* path;
  std::uint64_t points;
  const char* refusal = nullptr;
};

// Every PLY and text file of malformed/, and good files with features that readers often handle wrongly.
constexpr RealFile kRealFiles[] = {
    {"malformed/assimp/models/PLY/cube.ply", 8},
    {"malformed/assimp/models/PLY/cube_binary.ply", 8},
    {"malformed/assimp/models/PLY/cube_binary_header_with_RN_newline.ply", 8},
    {"malformed/assimp/models/PLY/cube_uv.ply", 24},
    {"malformed/assimp/models/PLY/float-color.ply", 3},
    {"malformed/assimp/models/PLY/issue623.ply", 0, "property 'vertex_indices' gives each vertex a list"},
    {"malformed/assimp/models/PLY/points.ply", 4},
    {"malformed/assimp/models/invalid/empty.obj", 0, "is empty"},
    {"malformed/assimp/models/invalid/empty.off", 0, "is empty"},
    {"malformed/assimp/models/invalid/empty.ply", 0, "is empty"},
    {"malformed/assimp/models/invalid/malformed.obj", 8},
    {"malformed/assimp/models/invalid/malformed2.obj", 8},
    {"malformed/assimp/models/invalid/readme.txt", 0, "is neither numbers nor a header"},
    {"malformed/bunny_variants/bun000.ply", 40256},
    {"malformed/cgal_edge/blobby.xyz", 3288},
    {"malformed/cgal_edge/cube.pwn", 50000},
    {"malformed/happly/platonic_shelf_ascii.ply", 50},
    {"malformed/happly/platonic_shelf_big_endian.ply", 50},
    {"malformed/lasvalidate/README.txt", 0, "is neither numbers nor a header"},
    {"malformed/lasvalidate/validate.xml", 0, "is an XML file"},
    {"malformed/pcl/octants.pcd", 8},
    {"malformed/pdal/las/vlr-43.bin", 0, "is neither numbers nor a header"},
    {"malformed/pdal/pcd/missingheader.pcd", 10},
    {"malformed/pdal/pcd/utm17_space.pcd", 10},
    {"malformed/pdal/pcd/utm17_tab.pcd", 10},
    {"malformed/pdal/ply/mesh.ply", 4},
    {"malformed/pdal/ply/mesh_fixed.ply", 4},
    {"malformed/pdal/ply/no_vertex.ply", 0, "has no element 'vertex'"},
    {"malformed/pdal/ply/simple_binary.ply", 3},
    {"malformed/pdal/ply/simple_text.ply", 3},
    {"malformed/pdal/ply/sized_dims.ply", 0, "have no z"},
    {"malformed/pdal/ply/text_extradim.ply", 1},
    {"malformed/pdal/text/badheader.txt", 0, "is neither numbers nor a header"},
    {"malformed/pdal/text/crlf_test.txt", 10},
    {"malformed/pdal/text/crlf_test2.txt", 10},
    {"malformed/pdal/text/duplicates-sorted.txt", 7},
    {"malformed/pdal/text/numeric_dim.txt", 5},
    {"malformed/pdal/text/quoted.txt", 9},
    {"malformed/pdal/text/quoted2.txt", 9},
    {"malformed/point-cloud-utils/bunny_duplicates.ply", 2895},
    {"models/cgal/b9_training.ply", 22300},
    {"models/cgal/ball.ply", 31374},
    {"models/cgal/blade.off", 8231},
    {"models/cgal/hippo1.ply", 6104},
    {"models/cgal/kitten.xyz", 5210},
    {"models/cgal/oni.pwn", 1435},
    {"models/cgal/radar.xyz", 20950},
    {"models/common3d/igea.ply", 134345},
    {"models/derived_big_endian/dragon_vrip_res3_be.ply", 22998},
    {"models/stanford_bunny/data/bun000.ply", 40256},
    {"models/stanford_bunny/reconstruction/bun_zipper.ply", 35947},
    {"models/stanford_dragon_stand/dragonStandRight_0.ply", 41841},
    {"scans/3dtk/scan000.3d", 81360},
    {"scans/libpointmatcher/car_cloud400.csv", 24989},
    {"scans/libpointmatcher/cloud.00000.vtk", 24989},
    {"scans/libpointmatcher/cloud.00001.vtk", 25193},
    {"scans/libpointmatcher/cloud.00002.vtk", 24154},
    {"scans/pdal/pts/autzen.pts", 10},
    {"scans/pdal/pts/bunny_8.pts", 9},
    {"scans/pdal/pts/site_56_8.pts", 8},
    {"scans/pdal/pts/test.pts", 19},
    {"scans/pdal/ptx/1.2-with-color.ptx", 1065},
    {"scans/pdal/ptx/complex-transform.ptx", 4},
    {"scans/pdal/ptx/multiple-and-transform.ptx", 8},
    {"scans/pdal/ptx/no-color.ptx", 15},
};

TEST(RealFiles, OpenOrAreRefusedAsTheTableSays) {
  if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  for (const RealFile& outcome : kRealFiles) {
    SCOPED_TRACE(outcome.path);
    const auto path = data_folder() / outcome.path;
    if (outcome.refusal != nullptr) {
      EXPECT_THAT(sentence_of<Error>([&] { open_reader(path); }), HasSubstr(outcome.refusal));
      continue;
    }
    const auto reader = open_reader(path);
    EXPECT_EQ(reader->info().count, outcome.points);
    EXPECT_EQ(all_records(*reader).size(), outcome.points * reader->info().schema.stride);
  }
}

TEST(RealFiles, TheTableNamesEveryMalformedPlyAndTextFile) {
  if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  std::set<std::string> named;
  for (const RealFile& outcome : kRealFiles) named.insert(outcome.path);
  for (const auto& entry : std::filesystem::recursive_directory_iterator(data_folder() / "malformed")) {
    const std::string extension = entry.path().extension();
    if (!entry.is_regular_file() || extension == ".las" || extension == ".laz" || extension == ".e57") continue;
    EXPECT_TRUE(named.contains(entry.path().lexically_relative(data_folder()).string())) << entry.path();
  }
}

TEST(RealFiles, SurviveBeingWrittenAndReadAgain) {
  if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  const TemporaryFolder folder;
  for (const char* name :
       {"models/cgal/b9_training.ply", "models/stanford_bunny/data/bun000.ply", "models/cgal/kitten.xyz",
        "models/derived_big_endian/dragon_vrip_res3_be.ply", "scans/pdal/pts/autzen.pts"}) {
    SCOPED_TRACE(name);
    const auto reader = open_reader(data_folder() / name);
    for (const char* extension : {".ply", ".csv"}) {
      OutputPlan plan =
          plan_for(folder / (std::string("out") + extension), reader->info().count, reader->info().schema);
      plan.extras = reader->info().extras;
      plan.overwrite = true;
      write_all(plan, all_records(*reader));
      const auto again = open_reader(plan.path);
      EXPECT_EQ(field_names(again->info().schema), field_names(reader->info().schema));
      for (const Field& field : plan.schema.fields) {
        // Text has a float in its shortest decimals, which are an equal float but another double.
        auto before = values_of(*reader, field.name), after = values_of(*again, field.name);
        if (field.type == Type::f32) {
          for (double& value : after) value = static_cast<float>(value);
        }
        EXPECT_EQ(before, after) << field.name;
      }
    }
  }
}

TEST(RealFiles, BigEndianDragonEqualsTheLittleEndianOne) {
  if (data_folder().empty()) GTEST_SKIP() << "the folder of real clouds is absent; set POINTSWEEP_DATA to it";
  const auto big = open_reader(data_folder() / "models/derived_big_endian/dragon_vrip_res3_be.ply");
  const auto original = open_reader(data_folder() / "models/stanford_dragon/dragon_vrip_res3.ply");
  EXPECT_EQ(all_records(*big), all_records(*original));
}

}  // namespace
}  // namespace pointsweep
