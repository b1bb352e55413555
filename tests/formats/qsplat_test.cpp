// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "pointsweep/error.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/qsplat/qsplat_walk.h"
#include "tests/formats/point_files.h"
#include "tests/formats/qsplat_test_file.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using namespace qsplat_test;

/// Returns all values of a leaf, in the order of the fields.
std::vector<double> values_in(const Leaf& leaf, bool has_color) {
  const auto normal = qsplat_normal(leaf.normal);
  std::vector<double> values(leaf.sphere.begin(), leaf.sphere.begin() + 3);
  values.insert(values.end(), normal.begin(), normal.end());
  values.push_back(leaf.sphere[3]);
  if (has_color) {
    for (const auto value : qsplat_color(leaf.color)) values.push_back(value);
  }
  return values;
}

std::vector<double> row_of(const Schema& schema, std::span<const std::byte> records, std::size_t row) {
  std::vector<double> values;
  for (const Field& field : schema.fields) values.push_back(value_of(field, records.data() + row * schema.stride));
  return values;
}

TEST(Qsplat, TheListOfSpheresIsTheOneOfCubesThatMeetTheParent) {
  const auto& all = cubes();
  ASSERT_EQ(all.size(), 7621u);
  for (unsigned code = 0; code < all.size(); ++code) {
    const auto sphere = qsplat_sphere(code, {0, 0, 0, 13});
    ASSERT_TRUE(sphere.has_value());
    EXPECT_NEAR(sphere->radius, all[code][0], 1e-5);
    EXPECT_NEAR(sphere->x, all[code][0] + 2 * all[code][1] - 13, 1e-5);
    EXPECT_NEAR(sphere->y, all[code][0] + 2 * all[code][2] - 13, 1e-5);
    EXPECT_NEAR(sphere->z, all[code][0] + 2 * all[code][3] - 13, 1e-5);
  }
  EXPECT_FALSE(qsplat_sphere(7621, {0, 0, 0, 1}).has_value());
}

TEST(Qsplat, NormalsAreUnitVectorsOnTheirFaceWhereverAnEncoderCanPutThem) {
  for (unsigned code = 0; code < 6 * 52 * 52; ++code) {
    const auto n = qsplat_normal(code);
    const std::size_t axis = code / (2 * 52 * 52);
    const double sign = code / (52 * 52) % 2 == 0 ? 1 : -1;
    const auto place = [](unsigned i) { return std::tan((2.0 * i + 1 - 52) / 52 * std::acos(-1.0) / 4); };
    const double u = place(code / 52 % 52), v = place(code % 52), rest = 1 - u * u - v * v;
    if (rest < 0) {
      EXPECT_EQ(n, (std::array<float, 3>{}));
      continue;
    }
    EXPECT_NEAR(n[axis], sign * std::sqrt(rest), 1e-4) << code;
    EXPECT_NEAR(n[(axis + 1) % 3], u, 1e-6) << code;
    EXPECT_NEAR(n[(axis + 2) % 3], v, 1e-6) << code;
  }
  EXPECT_EQ(qsplat_normal(16383), (std::array<float, 3>{0, 0, 1}));
}

TEST(Qsplat, ColorsReachBlackAndWhite) {
  EXPECT_EQ(qsplat_color(0), (std::array<std::uint8_t, 3>{0, 0, 0}));
  EXPECT_EQ(qsplat_color(0xffff), (std::array<std::uint8_t, 3>{255, 255, 255}));
  EXPECT_EQ(qsplat_color(0xf800), (std::array<std::uint8_t, 3>{255, 0, 0}));
  EXPECT_EQ(qsplat_color(1 << 5), (std::array<std::uint8_t, 3>{0, 4, 0}));
}

TEST(Qsplat, GivesTheLeavesOfATreeAsRecursionFindsThem) {
  const TemporaryFolder folder;
  for (const bool has_color : {false, true}) {
    for (const unsigned size : {2u, 5u, 100u, 200000u}) {
      const Tree tree = random_tree(size, has_color);
      const auto expected = leaves_in(tree);
      const auto reader = kQsplatFormat.open(folder.write("a.qs", tree.bytes()));
      const Schema& schema = reader->info().schema;
      ASSERT_EQ(reader->info().count, expected.size());
      ASSERT_EQ(schema.fields.size(), has_color ? 10u : 7u);
      const auto records = all_records(*reader, 777);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_EQ(row_of(schema, records, i), values_in(expected[i], has_color)) << "row " << i << " of " << size;
      }
    }
  }
}

TEST(Qsplat, ReadsFromAnyRow) {
  const TemporaryFolder folder;
  const Tree tree = random_tree(400000, false);
  const auto reader = kQsplatFormat.open(folder.write("a.qs", tree.bytes()));
  const std::uint64_t count = reader->info().count;
  ASSERT_GT(count, 70000u);
  const auto all = all_records(*reader);
  const std::size_t stride = reader->info().schema.stride;
  std::vector<std::byte> one(3 * stride);
  for (const std::uint64_t row : {count - 1, std::uint64_t{0}, std::uint64_t{32767}, std::uint64_t{32768},
                                  std::uint64_t{40000}, std::uint64_t{39999}}) {
    const std::size_t rows = reader->read(row, one);
    ASSERT_EQ(rows, std::min<std::uint64_t>(3, count - row));
    EXPECT_TRUE(std::equal(one.begin(), one.begin() + rows * stride, all.begin() + row * stride)) << row;
  }
  EXPECT_EQ(reader->read(count, one), 0u);
}

TEST(Qsplat, PartsFollowEachOtherAndCommentsAreSkipped) {
  const TemporaryFolder folder;
  const Tree plain = random_tree(50, false), colored = random_tree(80, true);
  const auto path = folder.write("a.qs", comment("made by a test") + plain.bytes() + colored.bytes() + comment("end"));
  const auto reader = open_reader(path);
  auto expected = leaves_in(plain);
  const std::size_t first = expected.size();
  for (const Leaf& leaf : leaves_in(colored)) expected.push_back(leaf);
  ASSERT_EQ(reader->info().count, expected.size());
  EXPECT_EQ(reader->info().format, "QSplat 11");
  const auto records = all_records(*reader);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (i < first) expected[i].color = 0;
    EXPECT_EQ(row_of(reader->info().schema, records, i), values_in(expected[i], true));
  }
  EXPECT_EQ(reader->info().bounds, (Box{{8, 18, 28}, {12, 22, 32}}));
}

TEST(Qsplat, ATreeThatIsNothingButItsRootIsOnePoint) {
  const TemporaryFolder folder;
  const auto reader = kQsplatFormat.open(folder.write("a.qs", Tree{}.bytes()));
  ASSERT_EQ(reader->info().count, 1u);
  EXPECT_EQ(row_of(reader->info().schema, all_records(*reader), 0), (std::vector<double>{10, 20, 30, 0, 0, 0, 2}));
}

TEST(Qsplat, EveryTruncationIsRefusedInOneSentence) {
  const TemporaryFolder folder;
  const std::string whole = random_tree(30, true).bytes();
  for (std::size_t size = 6; size < whole.size(); ++size) {
    const auto path = folder.write("a.qs", whole.substr(0, size));
    const auto sentence = sentence_of<Error>([&] { open_reader(path); });
    EXPECT_NE(sentence.find("damaged or was not copied completely"), sentence.npos) << size << ": " << sentence;
  }
}

/// Returns the sentence of the Error of opening `whole` after its bytes from `at` on were replaced by `bytes`.
std::string complaint_about(std::string whole, std::size_t at, std::string_view bytes) {
  const TemporaryFolder folder;
  whole.replace(at, bytes.size(), bytes);
  const auto path = folder.write("a.qs", whole);
  return sentence_of<Error>([&] { kQsplatFormat.open(path); });
}

TEST(Qsplat, LyingFilesAreRefusedWithThePlace) {
  using namespace std::string_view_literals;
  const std::string good = random_tree(30, false).bytes();
  const auto says = [](const std::string& sentence, std::string_view what) {
    EXPECT_NE(sentence.find(what), sentence.npos) << sentence;
  };
  says(complaint_about(good, 6, "10"sv), "another version of QSplat than 11");
  says(complaint_about(good, 8, "\0\0\0\x08"sv), "fewer than its header");
  says(complaint_about(good, 12, "\0\0\x30\x39"sv), "the header says 12345 leaves");
  says(complaint_about(good, 36, "\xff\xff\xff\xff"sv), "more children than the tree has leaves");
  says(complaint_about(good, 40, "\xff\xff\xff\xff"sv), "after the end of their part");
  says(complaint_about(good, 40, "\0\0\0\0"sv), "byte");
  says(complaint_about(good, 44, "\xff\xf8"sv), "the code of a sphere means nothing");
  says(complaint_about(good + "xyz", 0, "Q"sv), "ends inside a header");
}

TEST(Qsplat, ATreeThatPointsAtItselfEnds) {
  Tree tree;
  Node inner{0, 0, 0, {Node{}, Node{}}};
  tree.root.children = {Node{0, 0, 0, {inner, inner}}, Node{}};
  std::string bytes = tree.bytes();
  const std::size_t below_root = 40 + 4 + 2 * 4;
  ASSERT_EQ(bytes.substr(below_root, 4), std::string("\0\0\0\x0c", 4));
  for (const char distance : {'\0', '\x04'}) {
    const auto sentence = complaint_about(bytes, below_root, std::string{'\0', '\0', '\0', distance});
    EXPECT_NE(sentence.find("damaged"), sentence.npos) << sentence;
  }
}

TEST(Qsplat, AChainDeeperThanAnyModelIsRefused) {
  const TemporaryFolder folder;
  Node node;
  for (int i = 0; i < 300; ++i) node = Node{7000, 0, 0, {Node{}, node}};
  Tree tree;
  tree.root = node;
  const auto path = folder.write("a.qs", tree.bytes());
  const auto sentence = sentence_of<Error>([&] { kQsplatFormat.open(path); });
  EXPECT_NE(sentence.find("deeper than 256 levels"), sentence.npos) << sentence;
}

}  // namespace
}  // namespace pointsweep
