// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/registry.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;
using Numbers = std::vector<double>;

std::string floats(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

TEST(Kitti, IsReadWhereItIsAskedFor) {
  const TemporaryFolder folder;
  const auto path = folder.write("000000.bin", floats({1, 2, 3, 0.5f, 4, 5, 6, 0.25f, 0, 0, 7, 8, 9, 1, 2, 3}));
  const auto kitti = open_reader(path, "kitti");
  EXPECT_EQ(kitti->info().count, 4u);
  EXPECT_EQ(values_of(*kitti, "x"), (Numbers{1, 4, 0, 9}));
  EXPECT_EQ(values_of(*kitti, "intensity"), (Numbers{0.5, 0.25, 8, 3}));
  EXPECT_THAT(sentence_of<Error>([&] { open_reader(path); }),
              HasSubstr("name their format with --format kitti or float32-xyz"));
  EXPECT_THAT(sentence_of<Error>([&] { open_reader(path, "float32-xyz"); }),
              HasSubstr("64 bytes, which is no multiple of the 12"));
  EXPECT_THAT(sentence_of<UsageError>([&] { open_reader(path, "ply"); }),
              HasSubstr("'ply' is not one of kitti|float32-xyz"));
  const auto xyz = folder.write("points.bin", floats({1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(values_of(*open_reader(xyz, "float32-xyz"), "z"), (Numbers{3, 6}));
  EXPECT_THAT(sentence_of<Error>([&] { open_reader(xyz, "kitti"); }),
              HasSubstr("24 bytes, which is no multiple of the 16"));
  EXPECT_THAT(sentence_of<Error>([&] { open_reader(folder.write("empty.bin", ""), "kitti"); }), HasSubstr("is empty"));
}

/// KITTI files have no signature, and the first bytes of a coordinate may look like the signature of any format.
TEST(Kitti, IsNotTakenForAnotherFormat) {
  const TemporaryFolder folder;
  const auto path = folder.write("000001.bin", "v 1 2 3\nv 4 5 6\n");
  EXPECT_EQ(open_reader(path, "kitti")->info().count, 1u);
  EXPECT_EQ(open_reader(path)->info().format, "OBJ");
}

TEST(Kitti, MeetsFilesOfOtherFormatsInOneCloud) {
  const TemporaryFolder folder;
  const auto scan = folder.write("a.bin", floats({1, 2, 3, 0.5f}));
  const auto text = folder.write("b.xyz", "4 5 6 7\n");
  for (const auto& paths : {std::vector{scan, text}, std::vector{text, scan}}) {
    Cloud cloud(paths, {.format = "kitti"});
    Numbers x = values_of(cloud, cloud.schema(), cloud.count(), "x");
    std::ranges::sort(x);
    EXPECT_EQ(x, (Numbers{1, 4}));
    Numbers intensity = values_of(cloud, cloud.schema(), cloud.count(), "intensity");
    std::ranges::sort(intensity);
    EXPECT_EQ(intensity, (Numbers{0.5, 7}));
  }
}

TEST(KittiData, EveryScanOpens) {
  const std::filesystem::path scans = data_folder() / "scans/gtsam_points";
  if (!std::filesystem::exists(scans)) GTEST_SKIP() << "no real data in " << data_folder();
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(scans)) {
    if (entry.path().extension() != ".bin") continue;
    const auto reader = open_reader(entry.path(), "float32-xyz");
    EXPECT_EQ(reader->info().count, entry.file_size() / 12);
    ++files;
  }
  EXPECT_EQ(files, 9u);
  EXPECT_EQ(open_reader(scans / "newer_06/raw_00.bin", "float32-xyz")->info().count, 25109u);
}

}  // namespace
}  // namespace pointsweep
