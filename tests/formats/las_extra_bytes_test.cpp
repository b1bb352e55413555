// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_extra_bytes.h"

#include <gtest/gtest.h>

#include <limits>
#include <span>
#include <string>

#include "tests/formats/las_test_file.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using las_test::descriptor;

/// Returns the fields that `descriptors` add to a record of `length` bytes, of which the first 20 belong to the point
/// format.
Schema fields_of(const std::string& descriptors, std::uint32_t length = 1000) {
  Schema schema;
  schema.stride = 20;
  EXPECT_EQ(append_extra_bytes(text_bytes(descriptors), length, schema), std::nullopt);
  return schema;
}

TEST(LasExtraBytes, KnowTheTenTypes) {
  constexpr Type kTypes[] = {Type::u8,  Type::i8,  Type::u16, Type::i16, Type::u32,
                             Type::i32, Type::u64, Type::i64, Type::f32, Type::f64};
  for (int type = 1; type <= 10; ++type) {
    const Schema schema = fields_of(descriptor("first", type) + descriptor("second", 1));
    ASSERT_EQ(schema.fields.size(), 2u);
    EXPECT_EQ(schema.fields[0].type, kTypes[type - 1]);
    EXPECT_EQ(schema.fields[0].offset, 20u);
    EXPECT_TRUE(schema.fields[0].is_plain());
    EXPECT_EQ(schema.fields[1].offset, 20 + size_of(kTypes[type - 1]));
  }
}

TEST(LasExtraBytes, DeprecatedArraysAreFieldsOfTwoOrThreeValues) {
  const Schema schema = fields_of(descriptor("pair", 14) + descriptor("triple", 30));
  EXPECT_EQ(schema.fields[0].type, Type::i16);
  EXPECT_EQ(schema.fields[0].count, 2u);
  EXPECT_EQ(schema.fields[1].type, Type::f64);
  EXPECT_EQ(schema.fields[1].count, 3u);
  EXPECT_EQ(schema.stride, 20u + 4 + 24);
}

TEST(LasExtraBytes, ArraysWhoseScalesDifferBecomeSeveralFields) {
  const Schema schema = fields_of(descriptor("v", 23, 8, {0.1, 0.2, 0.3}));
  ASSERT_EQ(schema.fields.size(), 3u);
  EXPECT_EQ(schema.fields[2].name, "v[2]");
  EXPECT_EQ(schema.fields[2].scale, 0.3);
  EXPECT_EQ(schema.fields[2].offset, 24u);
}

TEST(LasExtraBytes, ScaleAndOffsetCountOnlyWhereTheOptionsSaySo) {
  EXPECT_TRUE(fields_of(descriptor("a", 3, 0, {0.5}, {7})).fields[0].is_plain());
  const Field scaled = fields_of(descriptor("a", 3, 8, {0.5}, {7})).fields[0];
  EXPECT_EQ(scaled.scale, 0.5);
  EXPECT_EQ(scaled.bias, 0);
  const Field moved = fields_of(descriptor("a", 3, 16, {0.5}, {7})).fields[0];
  EXPECT_EQ(moved.scale, 1);
  EXPECT_EQ(moved.bias, 7);
}

TEST(LasExtraBytes, ScalesThatCannotBeAreIgnored) {
  for (const double bad : {0.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(fields_of(descriptor("a", 3, 8, {bad})).fields[0].scale, 1);
  }
}

TEST(LasExtraBytes, UndocumentedBytesAreThatManyUint8) {
  const Schema schema = fields_of(descriptor("raw", 0, 7) + descriptor("none", 0, 0) + descriptor("a", 9));
  ASSERT_EQ(schema.fields.size(), 2u);
  EXPECT_EQ(schema.fields[0].type, Type::u8);
  EXPECT_EQ(schema.fields[0].count, 7u);
  EXPECT_EQ(schema.fields[1].offset, 27u);
}

TEST(LasExtraBytes, NamesAreCleanAndUnique) {
  const Schema schema =
      fields_of(descriptor("  Pulse width ", 1) + descriptor("pulse WIDTH", 1) +
                descriptor(std::string("a\nb\0c", 5), 1) + descriptor("", 1) + descriptor(std::string(32, 'n'), 1));
  EXPECT_EQ(schema.fields[0].name, "Pulse width");
  EXPECT_EQ(schema.fields[1].name, "pulse WIDTH_2");
  EXPECT_EQ(schema.fields[2].name, "a_b");
  EXPECT_EQ(schema.fields[3].name, "extra_bytes");
  EXPECT_EQ(schema.fields[4].name, std::string(32, 'n'));
}

TEST(LasExtraBytes, ThatDoNotFitAreExplainedAndChangeNothing) {
  Schema schema;
  schema.stride = 20;
  const Schema before = schema;
  const auto reason = [&](const std::string& descriptors) {
    return append_extra_bytes(text_bytes(descriptors), 23, schema).value_or("none");
  };
  EXPECT_EQ(reason(descriptor("a", 5)), "it describes 4 bytes of each point, where there are 3");
  EXPECT_EQ(reason(descriptor("a", 31)), "it has an attribute of the undefined type 31");
  EXPECT_EQ(reason(descriptor("a", 1) + "x"), "its 193 bytes are no multiple of 192");
  EXPECT_EQ(schema, before);
}

TEST(LasExtraBytes, DescribeEveryFieldSoThatItReadsBackTheSame) {
  Schema written;
  written.stride = 20;
  ExtraBytesVlr vlr;
  for (int type = 0; type < 10; ++type) {
    Field& field = written.fields[written.append("field " + std::to_string(type), static_cast<Type>(type))];
    if (type < 8) field.scale = 0.25;
    if (type == 3) field.bias = -7;
    vlr.append(field);
  }
  Schema read;
  read.stride = 20;
  EXPECT_EQ(append_extra_bytes(vlr.bytes(), written.stride, read), std::nullopt);
  EXPECT_EQ(read, written);
}

TEST(LasExtraBytes, CutLongNamesAndKeepThemApart) {
  ExtraBytesVlr vlr;
  Field field;
  field.name = std::string(40, 'a');
  vlr.append(field);
  field.name += "b";
  vlr.append(field);
  Schema read;
  ASSERT_EQ(append_extra_bytes(vlr.bytes(), 1000, read), std::nullopt);
  EXPECT_EQ(read.fields[0].name, std::string(26, 'a') + "_input");
  EXPECT_EQ(read.fields[1].name, std::string(32, 'a'));
}

TEST(LasExtraBytes, DescribeManyUndocumentedBytes) {
  ExtraBytesVlr vlr;
  vlr.append_undocumented(600);
  Schema read;
  ASSERT_EQ(append_extra_bytes(vlr.bytes(), 600, read), std::nullopt);
  EXPECT_EQ(read.stride, 600u);
  EXPECT_EQ(read.fields.size(), 3u);
}

}  // namespace
}  // namespace pointsweep
