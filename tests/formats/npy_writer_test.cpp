// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pointsweep/error.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

OutputPlan plan_of(const std::filesystem::path& path, Type type, std::uint32_t columns, std::uint64_t count) {
  OutputPlan plan = plan_for(path, count);
  plan.schema.append("neighbors", type, columns);
  return plan;
}

/// Expects a file as numpy.lib.format describes it: 6 bytes of magic, 2 of version, 2 of length, the dictionary, the
/// values.
void expect_array(const std::string& content, const std::string& dictionary, const std::string& values) {
  ASSERT_THAT(content, StartsWith(std::string("\x93NUMPY\x01\x00", 8)));
  const auto length = static_cast<unsigned char>(content[8]) + 256u * static_cast<unsigned char>(content[9]);
  EXPECT_EQ((10 + length) % 64, 0u);
  ASSERT_EQ(content.size(), 10 + length + values.size());
  EXPECT_THAT(content.substr(10, length), StartsWith(dictionary));
  EXPECT_EQ(content.substr(10 + dictionary.size(), length - dictionary.size() - 1).find_first_not_of(' '),
            std::string::npos);
  EXPECT_EQ(content[10 + length - 1], '\n');
  EXPECT_EQ(content.substr(10 + length), values);
}

TEST(NpyWriter, WritesATableInRowOrder) {
  const TemporaryFolder folder;
  const auto writer = create_npy_writer(plan_of(folder / "out.npy", Type::u32, 2, 2));
  const std::uint32_t values[] = {1, 2, 3, 0xffffffff};
  writer->write(std::as_bytes(std::span(values)));
  writer->finish();
  expect_array(contents(folder / "out.npy"), "{'descr': '<u4', 'fortran_order': False, 'shape': (2, 2), }",
               std::string(reinterpret_cast<const char*>(values), sizeof values));
}

TEST(NpyWriter, WritesAColumnInAnyOrderOfRows) {
  const TemporaryFolder folder;
  const auto writer = create_npy_writer(plan_of(folder / "out.npy", Type::f64, 1, 3));
  const double values[] = {0.5, -1, 1e300};
  ASSERT_TRUE(writer->can_write_at());
  writer->write_at(1, std::as_bytes(std::span(values).subspan(1)));
  writer->write_at(0, std::as_bytes(std::span(values).first(1)));
  writer->finish();
  expect_array(contents(folder / "out.npy"), "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }",
               std::string(reinterpret_cast<const char*>(values), sizeof values));
}

TEST(NpyWriter, AListOfOneValueIsATableAndANumberIsNot) {
  const TemporaryFolder folder;
  OutputPlan list = plan_of(folder / "list.npy", Type::u32, 1, 2), number = plan_of(folder / "n.npy", Type::u32, 1, 2);
  list.made = {{"neighbors", Type::u32, Kind::index, {"neighbor_0"}, "", ""}};
  number.made = {scalar("neighbors", Type::u32, "", "")};
  const std::uint32_t values[] = {1, 0};
  for (const OutputPlan& plan : {list, number}) {
    const auto writer = create_npy_writer(plan);
    writer->write(std::as_bytes(std::span(values)));
    writer->finish();
  }
  EXPECT_THAT(contents(folder / "list.npy"), HasSubstr("'shape': (2, 1), }"));
  EXPECT_THAT(contents(folder / "n.npy"), HasSubstr("'shape': (2,), }"));
}

TEST(NpyWriter, WritesAnEmptyTable) {
  const TemporaryFolder folder;
  create_npy_writer(plan_of(folder / "out.npy", Type::u8, 8, 0))->finish();
  expect_array(contents(folder / "out.npy"), "{'descr': '|u1', 'fortran_order': False, 'shape': (0, 8), }", "");
}

TEST(NpyWriter, RefusesMoreThanOneAttribute) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_of(folder / "out.npy", Type::f32, 1, 1);
  plan.schema.append("distance", Type::f32);
  EXPECT_THAT(sentence_of<UsageError>([&] { create_npy_writer(plan); }), HasSubstr("holds one attribute"));
}

}  // namespace
}  // namespace pointsweep
