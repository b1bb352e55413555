// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
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

const std::string kIdentity = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

class Ptx : public testing::Test {
 protected:
  std::unique_ptr<Reader> opened(const std::string& text) {
    return open_reader(folder_.write(fmt::format("scan{}", ++files_), text));
  }
  std::string refusal(const std::string& text) {
    return sentence_of<Error>([&] { values_of(*opened(text), "x"); });
  }
  const TemporaryFolder folder_;
  int files_ = 0;
};

/// The second scan is turned by 90 degrees about z and shifted: (x, y, z) becomes (100 - y, 200 + x, 300 + z).
TEST_F(Ptx, AppliesTheTransformationOfEachScan) {
  const auto reader =
      opened("1\n2\n" + kIdentity + "1 2 3 0.25\n4 5 6 0.5\n" +
             "1\r\n1\r\n9 9 9\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n100 200 300 1\n7 8 9 0.75 10 20 30\n");
  EXPECT_EQ(reader->info().format, "PTX, 2 scans");
  EXPECT_EQ(field_names(reader->info().schema),
            (std::vector<std::string>{"x", "y", "z", "intensity", "scan", "row", "column", "red", "green", "blue"}));
  EXPECT_EQ(values_of(*reader, "x"), (Numbers{1, 4, 92}));
  EXPECT_EQ(values_of(*reader, "y"), (Numbers{2, 5, 207}));
  EXPECT_EQ(values_of(*reader, "z"), (Numbers{3, 6, 309}));
  EXPECT_EQ(values_of(*reader, "intensity"), (Numbers{0.25, 0.5, 0.75}));
  EXPECT_EQ(values_of(*reader, "scan"), (Numbers{0, 0, 1}));
  EXPECT_EQ(values_of(*reader, "green"), (Numbers{0, 0, 20}));
  EXPECT_TRUE(reader->info().warnings.empty());
}

TEST_F(Ptx, LeavesOutEmptyCellsAndKeepsRowsAndColumnsOfTheOthers) {
  const auto reader = opened("2\n3\n" + kIdentity +
                             "0 0 0 0.5\n1 0 0 0\n0.000 -0 0e5 0.5\n\n0 2 0 0\nnan nan nan 0\n+0.0 0. .0 0.500000\n");
  EXPECT_EQ(values_of(*reader, "row"), (Numbers{1, 0, 1}));
  EXPECT_EQ(values_of(*reader, "column"), (Numbers{0, 1, 1}));
  EXPECT_EQ(values_of(*reader, "y")[1], 2);
  EXPECT_TRUE(std::isnan(values_of(*reader, "x")[2])) << "what the file calls NaN is a point";
  ASSERT_EQ(reader->info().warnings.size(), 1u);
  EXPECT_THAT(reader->info().warnings[0], HasSubstr("3 of its 6 cells are empty"));
}

/// Scans of many sizes, in which a third of the cells is empty, are read as a whole and from several rows on.
TEST_F(Ptx, AreReadInAnyOrder) {
  std::string text;
  Numbers expected;
  for (int scan = 0; scan < 40; ++scan) {
    const int cells = scan % 7 == 3 ? 0 : 997 + scan * 100;
    text += fmt::format("{}\n1\n", cells) + kIdentity;
    for (int i = 0; i < cells; ++i) {
      const bool empty = i % 3 == 1;
      text += empty ? "0 0 0 0.5\n" : fmt::format("{} {} 1 0.5\n", expected.size() + 1, scan);
      if (!empty) expected.push_back(static_cast<double>(expected.size() + 1));
    }
  }
  const auto reader = opened(text);
  EXPECT_EQ(values_of(*reader, "x"), expected);
  std::vector<std::byte> record(reader->info().schema.stride);
  for (const std::uint64_t row : {expected.size() - 1, std::size_t{0}, std::size_t{16384}, std::size_t{16383},
                                  std::size_t{40000}, std::size_t{5}}) {
    ASSERT_EQ(reader->read(row, record), 1u);
    EXPECT_EQ(value_of(reader->info().schema.fields[0], record.data()), expected[row]);
  }
  EXPECT_EQ(reader->read(expected.size(), record), 0u);
}

TEST_F(Ptx, WrongFilesAreOneSentence) {
  const std::string head = "1\n2\n" + kIdentity;
  EXPECT_THAT(refusal(head + "1 2 3 0\n"), HasSubstr("should have 1 × 2 cells, but the file ends after 1"));
  EXPECT_THAT(refusal("2000000000\n2000000000\n" + kIdentity + "1 2 3 0\n"), HasSubstr("the file ends after 1"));
  EXPECT_THAT(refusal("99999999999\n2\n" + kIdentity + "1 2 3 0\n"),
              HasSubstr("line 1 should hold a number of columns"));
  EXPECT_THAT(refusal("1.5\n2\n" + kIdentity + "1 2 3 0\n"), HasSubstr("line 1 should hold a number of columns"));
  EXPECT_THAT(refusal("-1\n2\n" + kIdentity + "1 2 3 0\n"), HasSubstr("line 1 should hold a number of columns"));
  EXPECT_THAT(refusal(head + "1 2 3 0\n4 5 x 0\n"), HasSubstr("line 12: 'x' is no number"));
  EXPECT_THAT(refusal(head + "1 2 3 0\n4 5\n"), HasSubstr("line 12: '' is no number"));
  EXPECT_THAT(refusal(head + "1 2 3 0\n4 5 6 7 8\n"), HasSubstr("line 12 has more than the 4 numbers"));
  EXPECT_THAT(refusal(head + "1 2 3 0 1 2 256\n4 5 6 7 8 9 9\n"), HasSubstr("line 11: '256' is no colour"));
  EXPECT_THAT(refusal(head + "1 2\n4 5\n"), HasSubstr("line 11, the first of scan 1, is not x y z"));
  EXPECT_THAT(refusal(head + "1 2 3\n4 5 6\n1\n1\n0 0 0\n"), HasSubstr("ends inside the header of scan 2"));
  EXPECT_THAT(refusal(head + "1 2 3\n4 5 6\n1\n1\n0 0\n"),
              HasSubstr("line 15, in the header of scan 2, should hold 3"));
  EXPECT_THAT(refusal("1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n1 2 3\n"),
              HasSubstr("should end with 0 0 0 1"));
  EXPECT_EQ(opened("0\n0\n" + kIdentity)->info().count, 0u);
}

/// A file that is truncated before its last number is refused. A shorter last number is another number.
TEST_F(Ptx, TruncatedFilesAreRefusedOrHaveAllCells) {
  const std::string whole = "1\n2\n" + kIdentity + "1 2 3 0.25\n4 5 6 0.5\n";
  for (std::size_t bytes = whole.find("1 2 3 0"); bytes <= whole.rfind(' '); ++bytes)
    EXPECT_THROW(values_of(*opened(whole.substr(0, bytes)), "x"), Error) << bytes;
  for (std::size_t bytes = whole.rfind(' ') + 2; bytes <= whole.size(); ++bytes)
    EXPECT_EQ(values_of(*opened(whole.substr(0, bytes)), "x"), (Numbers{1, 4})) << bytes;
}

TEST(PtxData, HasTheValuesOfTheFiles) {
  const std::filesystem::path scans = data_folder() / "scans/pdal/ptx";
  if (!std::filesystem::exists(scans)) GTEST_SKIP() << "no real data in " << data_folder();
  // The expected value is computed by hand from the matrix of the file. 8 of its 12 cells are 0 0 0.
  const auto turned = open_reader(scans / "complex-transform.ptx");
  EXPECT_EQ(turned->info().count, 4u);
  // -0.005630 * 0.999979 + 0.645218 * 0.003613 - 0.440506 * 0.005359 - 3.028748
  EXPECT_NEAR(values_of(*turned, "x")[0], -3.03440738, 1e-8);
  const auto several = open_reader(scans / "multiple-and-transform.ptx");
  const Numbers x = values_of(*several, "x"), z = values_of(*several, "z");
  ASSERT_EQ(x.size(), 8u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(x[i], x[i + 4], 1e-6) << "both scans hold the same points, one transformed";
    EXPECT_NEAR(z[i], z[i + 4], 1e-6);
  }
}

}  // namespace
}  // namespace pointsweep
