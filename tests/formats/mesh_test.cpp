// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/registry.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/data_folder.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;
using Numbers = std::vector<double>;

class Meshes : public testing::Test {
 protected:
  std::unique_ptr<Reader> opened(const std::string& text) { return open_reader(folder_.write("mesh", text)); }
  std::string refusal(const std::string& text) {
    return sentence_of<Error>([&] { values_of(*opened(text), "x"); });
  }
  const TemporaryFolder folder_;
};

TEST_F(Meshes, OffGivesItsVerticesAndSaysThatFacesAreLeftOut) {
  const auto reader = opened(
      "OFF # by hand\r\n# a comment\r\n\r\n3 1 0\r\n0 1 2\r\n# between\r\n-1.5 1e3 7\r\n4 5 6 # last\r\n3 0 1 2\r\n");
  EXPECT_EQ(reader->info().format, "OFF");
  EXPECT_EQ(values_of(*reader, "x"), (Numbers{0, -1.5, 4}));
  EXPECT_EQ(values_of(*reader, "y"), (Numbers{1, 1000, 5}));
  EXPECT_EQ(values_of(*reader, "z"), (Numbers{2, 7, 6}));
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  EXPECT_THAT(reader->info().warnings[0], HasSubstr("its 1 faces are left out"));
}

TEST_F(Meshes, OffHasNormalsColorsAndTextureAsItsKeywordSays) {
  const auto all = opened("STCNOFF 1 0 0\n1 2 3 0 0 1 0.5 1 0 1 0.25 0.75\n");
  EXPECT_EQ(values_of(*all, "nz"), Numbers{1});
  EXPECT_EQ(values_of(*all, "red"), Numbers{128});
  EXPECT_EQ(values_of(*all, "green"), Numbers{255});
  EXPECT_EQ(values_of(*all, "alpha"), Numbers{255});
  EXPECT_EQ(values_of(*all, "texture_v"), Numbers{0.75});
  const auto plain = opened("OFF\n2 0 0\n1 2 3 1 1 0\n4 5 6 255 0 128\n");
  EXPECT_EQ(values_of(*plain, "red"), (Numbers{1, 255})) << "no fractions, since one number is larger than 1";
  EXPECT_EQ(values_of(*plain, "blue"), (Numbers{0, 128}));
}

TEST_F(Meshes, ObjGivesVerticesColorsAndNormalsThatAreOneForEach) {
  const auto reader = opened(
      "# Blender\nmtllib a.mtl\no thing\nv 1 2 3 0.5 0 1\nvt 0 0\nvn 0 0 1\n v 4 5 6 1 1 1\nvn 1 0 0\nf 1//1 2//2 "
      "1//1\n");
  EXPECT_EQ(reader->info().format, "OBJ");
  EXPECT_EQ(values_of(*reader, "x"), (Numbers{1, 4}));
  EXPECT_EQ(values_of(*reader, "red"), (Numbers{128, 255}));
  EXPECT_EQ(values_of(*reader, "nx"), (Numbers{0, 1}));
  EXPECT_EQ(values_of(*reader, "nz"), (Numbers{1, 0}));
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  const auto other = opened("v 1 2 3 1.0\nv 4 5 6 1.0\nvn 0 0 1\n");
  EXPECT_EQ(values_of(*other, "z"), (Numbers{3, 6}));
  EXPECT_FALSE(other->info().schema.find("nx"));
  ASSERT_EQ(other->info().warnings.size(), 1u);
  EXPECT_THAT(other->info().warnings[0], HasSubstr("its 1 normals are left out"));
}

TEST_F(Meshes, AreReadInAnyOrder) {
  std::string text = "OFF\n100000 0 0\n";
  for (int i = 0; i < 100000; ++i) text += std::to_string(i) + " 0 0\n";
  const auto reader = opened(text);
  std::vector<std::byte> record(reader->info().schema.stride);
  for (const std::uint64_t row : {99999, 5, 70000, 65536, 65535, 0}) {
    ASSERT_EQ(reader->read(row, record), 1u);
    EXPECT_EQ(value_of(reader->info().schema.fields[0], record.data()), static_cast<double>(row));
  }
  EXPECT_EQ(reader->read(100000, record), 0u);
}

TEST_F(Meshes, WrongFilesAreOneSentence) {
  EXPECT_THAT(refusal("OFF\n3 0 0\n1 2 3\n4 5 6\n"), HasSubstr("says 3 vertices, but the file ends after 2"));
  EXPECT_THAT(refusal("OFF\n99999999999999 0 0\n1 2 3\n"), HasSubstr("the file ends after 1"));
  EXPECT_THAT(refusal("OFF BINARY\n\1\2"), HasSubstr("is a binary OFF file"));
  EXPECT_THAT(refusal("OFF\n# nothing\n"), HasSubstr("ends before the numbers"));
  EXPECT_THAT(refusal("OFF\nmany\n"), HasSubstr("line 2 should hold the numbers"));
  EXPECT_THAT(refusal("OFF\n2 0 0\n1 2 3\n4 5\n"), HasSubstr("line 4 has 2 numbers where the first vertex has 3"));
  EXPECT_THAT(refusal("OFF\n1 0 0\n1 2 x\n"), HasSubstr("line 3: 'x' is no number"));
  EXPECT_THAT(refusal("NOFF\n1 0 0\n1 2 3\n"), HasSubstr("has 3 numbers, which cannot be coordinates, a normal"));
  EXPECT_THAT(refusal("OFF\n1 0 0\n1 2 3 4\n"), HasSubstr("has 4 numbers"));
  EXPECT_THAT(refusal("v 1 2\n"), HasSubstr("has 2 numbers instead of x y z"));
  EXPECT_THAT(refusal("v 1 2 3\nv 1 2 3 4\n"), HasSubstr("line 2 has 4 numbers where the first vertex has 3"));
  EXPECT_EQ(opened("OFF\n0 0 0\n")->info().count, 0u);
  EXPECT_EQ(opened("o empty\n")->info().count, 0u);
}

TEST(MeshData, HasThePointsOfTheInventory) {
  const std::filesystem::path models = data_folder() / "models";
  if (!std::filesystem::exists(models)) GTEST_SKIP() << "no real data in " << data_folder();
  const auto off = open_reader(models / "cgal/blade.off");
  EXPECT_EQ(off->info().count, 8231u);
  EXPECT_EQ(values_of(*off, "y").at(1), 14.8637);
  const auto obj = open_reader(models / "common3d/rocker-arm.obj");
  EXPECT_EQ(obj->info().count, 10044u);
  EXPECT_EQ(values_of(*obj, "z").at(2), 0.5);
}

}  // namespace
}  // namespace pointsweep
