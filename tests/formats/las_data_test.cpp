// SPDX-License-Identifier: MIT
/// Real LAS files of many programs, and broken files, from the folder POINTSWEEP_DATA, with the expected outcome of
/// copying each.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/las/las_format.h"
#include "pointsweep/formats/las/las_reader.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

enum Outcome {
  kSame,      ///< a copy has the same bytes
  kRepaired,  ///< a copy differs only in the counts and bounds of the header, which are wrong or rounded in the input
  kRefused,
};

struct LasFile {
  const char* file;
  std::uint64_t points;
  Outcome outcome;
  const char* sentence = "";  ///< part of the error, or of the only warning
};

constexpr LasFile kLasFiles[] = {
    {"lidar/ign_las-digital-models/ground/test_data_77050_627755_LA93_IGN69.las", 21172, kSame},
    {"lidar/ign_las-digital-models/ground/test_data_77050_627760_LA93_IGN69.las", 33568, kSame},
    {"lidar/ign_las-digital-models/ground/test_data_77055_627755_LA93_IGN69.las", 39468, kSame},
    {"lidar/ign_las-digital-models/ground/test_data_77055_627760_LA93_IGN69.las", 22343, kSame},
    {"lidar/jakteristics_mobile/test_0.02_seconde.las", 10310, kRepaired},
    {"lidar/ky_lock4/ky_lock4_west.las", 917296, kSame},
    {"lidar/lasR/Example.las", 30, kSame},
    {"lidar/lasR/Megaplot.las", 81590, kSame},
    {"lidar/lasR/Topography.las", 73403, kSame},
    {"lidar/lasR/extra_byte.las", 62, kSame},
    {"lidar/lasR/nocrs.las", 30, kSame},
    {"lidar/laspy/1_4_w_evlr.las", 1000, kSame},
    {"lidar/laspy/autzen_geo_proj.las", 106, kSame},
    {"lidar/laspy/simple1_1.las", 1065, kSame},
    {"lidar/laspy/simple1_4.las", 22600, kRepaired},
    {"lidar/laspy/vegetation_1_3.las", 10683, kSame},
    {"lidar/laz-perf/1815.las", 1247, kSame},
    {"lidar/laz-perf/extrabytes.las", 1065, kSame},
    {"lidar/laz-perf/point-color-time.las", 1065, kSame},
    {"lidar/laz-perf/point-color.las", 1065, kSame},
    {"lidar/laz-perf/point-time.las", 1065, kSame},
    {"lidar/laz-perf/point10.las", 1065, kSame},
    {"lidar/libLAS/srs_utm17.las", 10, kRepaired},
    {"lidar/libLAS/srs_vertcs.las", 10, kRepaired},
    {"lidar/pdal/autzen/autzen-attribute-cropped.las", 86, kRepaired},
    {"lidar/pdal/autzen/autzen-bmx-2010.las", 829, kSame},
    {"lidar/pdal/autzen/autzen-bmx-2023.las", 687, kSame},
    {"lidar/pdal/autzen/autzen-dd.las", 1065, kRepaired},
    {"lidar/pdal/autzen/autzen-point-format-3.las", 106, kSame},
    {"lidar/pdal/autzen/autzen-thin-srs.las", 10653, kRepaired},
    {"lidar/pdal/autzen/autzen-thin.las", 10653, kRepaired},
    {"lidar/pdal/autzen/autzen-utm-chipped-25.las", 1065, kSame},
    {"lidar/pdal/autzen/autzen-utm.las", 1065, kRepaired},
    {"lidar/pdal/autzen/autzen.las", 106, kSame},
    {"lidar/pdal/filters/crop-on-edge/crop.las", 510, kSame},
    {"lidar/pdal/las/1.2-empty-geotiff-vlrs.las", 43, kRepaired},
    {"lidar/pdal/las/1.2-with-color.las", 1065, kSame},
    {"lidar/pdal/las/100-points.las", 100, kSame},
    {"lidar/pdal/las/autzen_trim.las", 110000, kRepaired},
    {"lidar/pdal/las/extrabytes.las", 1065, kSame},
    {"lidar/pdal/las/interesting.las", 1065, kRepaired},
    {"lidar/pdal/las/lots_of_vlr.las", 1, kSame},
    {"lidar/pdal/las/noise-dirty.las", 1065, kSame},
    {"lidar/pdal/las/permutations/1.0_0.las", 1, kSame},
    {"lidar/pdal/las/permutations/1.0_1.las", 1, kSame},
    {"lidar/pdal/las/permutations/1.1_0.las", 1, kSame},
    {"lidar/pdal/las/permutations/1.1_1.las", 1, kSame},
    {"lidar/pdal/las/permutations/1.2_0.las", 1, kSame},
    {"lidar/pdal/las/permutations/1.2_1.las", 1, kSame},
    {"lidar/pdal/las/permutations/1.2_2.las", 1, kSame},
    {"lidar/pdal/las/permutations/1.2_3.las", 1, kSame},
    {"lidar/pdal/las/prec3.las", 110, kSame},
    {"lidar/pdal/las/simple.las", 1065, kSame},
    {"lidar/pdal/las/spec_3.las", 10, kSame},
    {"lidar/pdal/las/test1_4.las", 1000, kRepaired},
    {"lidar/pdal/las/test_epsg_4047.las", 10, kRepaired},
    {"lidar/pdal/las/test_epsg_4326.las", 10, kRepaired},
    {"lidar/pdal/las/test_epsg_4326_axis.las", 10, kSame},
    {"lidar/pdal/las/test_epsg_4326x3.las", 30, kSame},
    {"lidar/pdal/las/test_utm16.las", 10, kRepaired},
    {"lidar/pdal/las/utm15.las", 1, kRepaired},
    {"lidar/pdal/las/utm17.las", 10, kRepaired},
    {"lidar/pdal/las/wontcompress3.las", 1000, kRepaired},
    {"malformed/lasR/malformed_extrabytes.las", 10, kRepaired,
     "the extra-bytes VLR at byte 227 was ignored: it describes 2 bytes"},
    {"malformed/laspy/unregistered_extra_bytes.las", 4, kSame},
    {"malformed/lasvalidate/las12.las", 8144, kSame},
    {"malformed/lasvalidate/las12_bounding_box.las", 8144, kRepaired},
    {"malformed/lasvalidate/las12_creation_date.las", 8144, kSame},
    {"malformed/lasvalidate/las12_global_encoding.las", 8144, kSame},
    {"malformed/lasvalidate/las12_header_size.las", 0, kRefused,
     "a header of 226 bytes (byte 94) is too short for LAS 1.2"},
    {"malformed/lasvalidate/las12_number_of_points_by_return.las", 8144, kRepaired},
    {"malformed/lasvalidate/las12_point_data_format.las", 0, kRefused, "point format 14 (byte 104) is not defined"},
    {"malformed/laz-perf/no-points-1.3.las", 0, kSame},
    {"malformed/laz-perf/point10-1.0.las", 1, kSame},
    {"malformed/laz-perf/point10-1.1.las", 1, kSame},
    {"malformed/libLAS/certainty3d-color-utm-feet-navd88.las", 10126, kRepaired},
    {"malformed/pdal/las/1.2-with-color-clipped.las", 0, kRefused, "counts 1065 points, but the file ends after 1064"},
    {"malformed/pdal/las/bad-geotiff-keys.las", 10, kRepaired},
    {"malformed/pdal/las/bad_vlr_count.las", 10, kRepaired, "promises 3 VLRs, but only 2 fit"},
    {"malformed/pdal/las/hextest.las", 8, kSame},
    {"malformed/pdal/las/no-points.las", 0, kSame},
    {"malformed/pdal/las/synthetic_test.las", 1, kSame},
    {"scans/sheridan/sheridan_A.las", 609414, kSame},
};

bool in_statistics(std::size_t byte, int minor) {
  return (byte >= 107 && byte < 131) || (byte >= 179 && byte < 227) || (minor == 4 && byte >= 247 && byte < 375);
}

/// Copies the points in blocks that do not divide the file evenly.
void copy(Reader& reader, const std::filesystem::path& to) {
  OutputPlan plan;
  plan.path = to;
  plan.schema = reader.info().schema;
  plan.count = reader.info().count;
  plan.extras = reader.info().extras;
  const auto writer = create_las_writer(plan);
  std::vector<std::byte> records(plan.schema.stride * 1009);
  for (std::uint64_t row = 0; row < plan.count;) {
    const std::size_t rows = reader.read(row, records);
    writer->write(std::span(records).first(rows * plan.schema.stride));
    row += rows;
  }
  writer->finish();
}

void check_copy(const std::string& in, const std::string& out, Outcome outcome) {
  ASSERT_EQ(out.size(), in.size());
  bool same = true;
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (in[i] == out[i]) continue;
    same = false;
    ASSERT_TRUE(in_statistics(i, in[25])) << "byte " << i;
  }
  EXPECT_EQ(same, outcome == kSame);
}

TEST(LasData, EveryFileHasItsPointsOrItsSentence) {
  if (!std::filesystem::exists(data_folder() / "lidar")) GTEST_SKIP() << "no real data in " << data_folder();
  const TemporaryFolder folder;
  for (const LasFile& row : kLasFiles) {
    SCOPED_TRACE(row.file);
    const std::filesystem::path path = data_folder() / row.file;
    if (row.outcome == kRefused) {
      const std::string sentence = sentence_of<Error>([&] { open_las(path); });
      EXPECT_NE(sentence.find(row.sentence), std::string::npos) << sentence;
      continue;
    }
    const auto reader = open_las(path);
    EXPECT_EQ(reader->info().count, row.points);
    const std::vector<std::string>& warnings = reader->info().warnings;
    ASSERT_EQ(warnings.size(), *row.sentence == 0 ? 0u : 1u);
    if (!warnings.empty()) {
      EXPECT_NE(warnings[0].find(row.sentence), std::string::npos) << warnings[0];
    }
    copy(*reader, folder / "copy.las");
    check_copy(contents(path), contents(folder / "copy.las"), row.outcome);
    std::filesystem::remove(folder / "copy.las");
  }
}

}  // namespace
}  // namespace pointsweep
