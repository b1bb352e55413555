// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pointsweep/error.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Arrays, AreReadAsPointsWithTheirAttributes) {
  const std::vector<double> xyz{1, 2, 3, 4, 5, 6};
  const std::vector<float> normals{0, 0, 1, 0, 1, 0};
  ArrayReader reader{std::span(xyz)};
  reader.add({"nx", "ny", "nz"}, normals);
  EXPECT_EQ(reader.info().count, 2u);
  EXPECT_EQ(reader.info().schema.stride, 36u);
  EXPECT_THAT(values_of(reader, "y"), ElementsAre(2, 5));
  EXPECT_THAT(values_of(reader, "nz"), ElementsAre(1, 0));
  EXPECT_EQ(all_records(reader, 1), all_records(reader));
}

TEST(Arrays, OfTheWrongSizeAreRefused) {
  const std::vector<float> four(4);
  EXPECT_THAT(sentence_of<UsageError>([&] { ArrayReader{std::span(four)}; }), HasSubstr("holds 4 values"));
  const std::vector<float> xyz(6);
  ArrayReader reader{std::span(xyz)};
  EXPECT_THAT(sentence_of<UsageError>([&] { reader.add({"i"}, std::span(four)); }), HasSubstr("2 points need 2"));
}

TEST(Arrays, CollectTheFieldsAskedFor) {
  OutputPlan plan = plan_for("unused", 2);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) plan.schema.append(name, Type::f32);
  plan.schema.append("row", Type::u64);
  std::vector<std::byte> records(2 * plan.schema.stride);
  for (std::size_t f = 0; f < 7; ++f) {
    set_value(plan.schema.fields[f], records.data(), 10.0 + static_cast<double>(f));
    set_value(plan.schema.fields[f], records.data() + plan.schema.stride, 20.0 + static_cast<double>(f));
  }
  std::vector<float> normals(6);
  ArrayWriter<float> floats(plan, {"nx", "ny", "nz"}, normals);
  floats.write(records);
  floats.finish();
  EXPECT_THAT(normals, ElementsAre(13, 14, 15, 23, 24, 25));
  std::vector<std::uint64_t> rows(2);
  ArrayWriter<std::uint64_t> integers(plan, {"row"}, rows);
  integers.write_at(1, std::span(records).subspan(plan.schema.stride));
  EXPECT_THAT(sentence_of<Error>([&] { integers.finish(); }), HasSubstr("only 1 of the 2"));
  integers.write_at(0, std::span(records).first(plan.schema.stride));
  integers.finish();
  EXPECT_THAT(rows, ElementsAre(16, 26));
}

TEST(Arrays, WithoutRoomOrFieldAreRefused) {
  OutputPlan plan = plan_for("unused", 2);
  plan.schema.append("x", Type::f32);
  std::vector<double> one(1), two(2);
  EXPECT_THAT(sentence_of<UsageError>([&] { ArrayWriter<double>(plan, {"x"}, one); }), HasSubstr("room for 1 values"));
  EXPECT_THAT(sentence_of<UsageError>([&] { ArrayWriter<double>(plan, {"nx"}, two); }), HasSubstr("no field 'nx'"));
}

}  // namespace
}  // namespace pointsweep
