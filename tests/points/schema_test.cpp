// SPDX-License-Identifier: MIT
#include "pointsweep/points/schema.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "pointsweep/error.h"
#include "tests/support/fixed_seed.h"

namespace pointsweep {
namespace {

constexpr std::array kTypes{Type::i8,  Type::u8,  Type::i16, Type::u16, Type::i32,
                            Type::u32, Type::i64, Type::u64, Type::f32, Type::f64};

Schema schema_of(std::initializer_list<const char*> names, Type type = Type::f32) {
  Schema schema;
  for (const char* name : names) schema.append(name, type);
  return schema;
}

TEST(Schema, AppendsFieldsBehindEachOther) {
  Schema schema;
  EXPECT_EQ(schema.append("a", Type::u8), 0u);
  EXPECT_EQ(schema.append("b", Type::f64, 3), 1u);
  EXPECT_EQ(schema.fields[1].offset, 1u);
  EXPECT_EQ(schema.stride, 25u);
}

TEST(Schema, KnowsSizesAndNamesOfAllTypes) {
  const std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  for (std::size_t i = 0; i < kTypes.size(); ++i) EXPECT_EQ(size_of(kTypes[i]), sizes[i]);
  EXPECT_EQ(name_of(Type::i8), "int8");
  EXPECT_EQ(name_of(Type::u64), "uint64");
  EXPECT_EQ(name_of(Type::f64), "float64");
}

TEST(Schema, FindsEverySpellingInAnyCase) {
  for (const char* spelling : {"nx", "NX", "normal_x", "NormalX", "normalx", "Normal X"}) {
    EXPECT_EQ(schema_of({"x", "y", "z", spelling}).find("nx"), 3u) << spelling;
  }
  EXPECT_EQ(schema_of({"X", "Y", "Z"}).find("y"), 1u);
  EXPECT_EQ(schema_of({"diffuse_red"}).find("red"), 0u);
  EXPECT_EQ(schema_of({"scalar_Intensity"}).find("intensity"), 0u);
  EXPECT_EQ(schema_of({"GpsTime"}).find("gps_time"), 0u);
  EXPECT_EQ(schema_of({"x", "y"}).find("nx"), std::nullopt);
}

TEST(Schema, PrefersTheBetterSpellingWhereverItStands) { EXPECT_EQ(schema_of({"normal_x", "nx"}).find("nx"), 1u); }

TEST(Schema, AnUnknownNameIsItsOnlySpelling) {
  EXPECT_EQ(spellings_of("roughness"), std::vector<std::string>{"roughness"});
  EXPECT_EQ(spellings_of("nx").front(), "nx");
}

TEST(Schema, TellsTheLibraryNameOfASpelling) {
  EXPECT_EQ(library_name_of("NormalX"), "nx");
  EXPECT_EQ(library_name_of("Diffuse_Red"), "red");
  EXPECT_EQ(library_name_of("X"), "x");
  EXPECT_EQ(library_name_of("Roughness"), "roughness");
  EXPECT_EQ(library_name_of(""), "");
}

TEST(Values, SmallIntegersSurviveInEveryType) {
  rc::check([] {
    Field field;
    field.type = *rc::gen::elementOf(kTypes);
    field.offset = *rc::gen::inRange(0u, 9u);
    field.count = 3;
    const double value = *rc::gen::inRange(0, 128);
    std::array<std::byte, 40> record{};
    const std::uint32_t component = *rc::gen::inRange(0u, 3u);
    set_value(field, record.data(), value, component);
    RC_ASSERT(value_of(field, record.data(), component) == value);
  });
}

TEST(Values, RoundToNearestAndSaturateAtTheEndsOfTheType) {
  std::array<std::byte, 8> record{};
  const auto stored = [&](Type type, double value) {
    Field field;
    field.type = type;
    set_value(field, record.data(), value);
    return value_of(field, record.data());
  };
  EXPECT_EQ(stored(Type::u8, 2.6), 3);
  EXPECT_EQ(stored(Type::u8, -5), 0);
  EXPECT_EQ(stored(Type::u8, 1e300), 255);
  EXPECT_EQ(stored(Type::i16, -1e9), -32768);
  EXPECT_EQ(stored(Type::i32, std::nan("")), 0);
  EXPECT_EQ(stored(Type::u64, std::numeric_limits<double>::infinity()), 18446744073709551616.0);
  EXPECT_EQ(stored(Type::i64, -std::numeric_limits<double>::infinity()), -9223372036854775808.0);
  EXPECT_TRUE(std::isnan(stored(Type::f32, std::nan(""))));
  EXPECT_TRUE(std::signbit(stored(Type::f64, -0.0)));
}

TEST(Values, ScaleAndBiasAreAppliedAndDividedOut) {
  Field field;
  field.type = Type::i32;
  field.scale = 0.001;
  field.bias = 500000;
  std::array<std::byte, 4> record{};
  const std::int32_t raw = -123456789;
  std::memcpy(record.data(), &raw, 4);
  EXPECT_EQ(value_of(field, record.data()), -123456789.0 * 0.001 + 500000);
  set_value(field, record.data(), value_of(field, record.data()));
  std::int32_t again = 0;
  std::memcpy(&again, record.data(), 4);
  EXPECT_EQ(again, raw);
}

TEST(Values, BitFieldsShareAByteWithoutTouchingEachOther) {
  Field low, high;
  low.type = high.type = Type::u8;
  low.bit_width = 3;
  high.bit_shift = 3;
  high.bit_width = 4;
  std::byte record{0x80};
  set_value(low, &record, 5);
  set_value(high, &record, 99);
  EXPECT_EQ(value_of(low, &record), 5);
  EXPECT_EQ(value_of(high, &record), 15);
  EXPECT_EQ(record, std::byte{0x80 | 15 << 3 | 5});
}

TEST(Positions, EqualValueOfForEveryTypeAndScale) {
  rc::check([] {
    Schema schema;
    for (const char* name : {"pad", "x", "gap", "y", "z"}) schema.append(name, *rc::gen::elementOf(kTypes));
    for (const std::size_t i : {1, 3, 4}) {
      if (*rc::gen::arbitrary<bool>()) schema.fields[i].scale = 0.01, schema.fields[i].bias = 4.5e6;
    }
    const auto count = *rc::gen::inRange<std::size_t>(0, 700);
    const auto bytes =
        *rc::gen::container<std::vector<std::uint8_t>>(count * schema.stride, rc::gen::arbitrary<std::uint8_t>());
    const auto* records = reinterpret_cast<const std::byte*>(bytes.data());
    std::vector<double> x(count), y(count), z(count);
    const PositionFields fields = position_fields(schema, "here");
    decode_positions(fields, records, schema.stride, count, x.data(), y.data(), z.data());
    for (std::size_t i = 0; i < count; ++i) {
      const double expected[] = {value_of(fields.x, records + i * schema.stride),
                                 value_of(fields.y, records + i * schema.stride),
                                 value_of(fields.z, records + i * schema.stride)};
      RC_ASSERT(std::memcmp(&expected[0], &x[i], 8) == 0 && std::memcmp(&expected[1], &y[i], 8) == 0 &&
                std::memcmp(&expected[2], &z[i], 8) == 0);
    }
  });
}

TEST(Positions, MissingCoordinateIsAnErrorThatNamesFileAndField) {
  try {
    position_fields(schema_of({"x", "y", "w"}), "scan.ply");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "scan.ply: its points have no z; a point cloud needs the fields x, y and z (fields found: x, y, w).");
  }
}

TEST(RecordConversion, CopiesEqualFieldsBitForBitAndConvertsOthers) {
  Schema from = schema_of({"a", "b"}, Type::f64);
  from.append("n", Type::i32);
  Schema to;
  to.append("n", Type::i16);
  to.append("missing", Type::f32);
  to.append("a", Type::f64);
  to.append("b", Type::f64);
  std::array<std::byte, 20> record{};
  const std::uint64_t signalling = 0x7ff0000000000001u;
  std::memcpy(record.data(), &signalling, 8);
  set_value(from.fields[1], record.data(), 0.1);
  set_value(from.fields[2], record.data(), 70000);
  std::array<std::byte, 22> out;
  out.fill(std::byte{0xff});
  const RecordConversion conversion(from, to);
  EXPECT_FALSE(conversion.is_identity());
  conversion.run(record.data(), out.data(), 1);
  EXPECT_EQ(std::memcmp(out.data() + 6, record.data(), 16), 0);
  EXPECT_EQ(value_of(to.fields[0], out.data()), 32767);
  EXPECT_EQ(value_of(to.fields[1], out.data()), 0);
}

TEST(RecordConversion, EqualSchemasCopyEveryByteEvenUnnamedOnes) {
  Schema schema = schema_of({"x"});
  schema.stride = 7;
  const RecordConversion conversion(schema, schema);
  EXPECT_TRUE(conversion.is_identity());
  const std::array<std::uint8_t, 14> in{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14};
  std::array<std::uint8_t, 14> out{};
  conversion.run(reinterpret_cast<const std::byte*>(in.data()), reinterpret_cast<std::byte*>(out.data()), 2);
  EXPECT_EQ(in, out);
}

TEST(RecordConversion, FieldsThatRepeatANameKeepTheirOwnValues) {
  const Schema from = schema_of({"v", "v"}, Type::u8), to = schema_of({"v", "v"}, Type::u16);
  const std::array<std::byte, 2> in{std::byte{3}, std::byte{9}};
  std::array<std::byte, 4> out{};
  RecordConversion(from, to).run(in.data(), out.data(), 1);
  EXPECT_EQ(value_of(to.fields[0], out.data()), 3);
  EXPECT_EQ(value_of(to.fields[1], out.data()), 9);
}

TEST(RecordConversion, ArraysOfDifferentLengthsKeepAllBitsOfTheirValues) {
  Schema from, to;
  from.append("v", Type::u64, 2);
  to.append("v", Type::u64, 3);
  const std::array<std::uint64_t, 2> in{(std::uint64_t{1} << 53) + 1, ~std::uint64_t{0}};
  std::array<std::uint64_t, 3> out{7, 7, 7};
  RecordConversion(from, to).run(reinterpret_cast<const std::byte*>(in.data()),
                                 reinterpret_cast<std::byte*>(out.data()), 1);
  EXPECT_EQ(out, (std::array<std::uint64_t, 3>{in[0], in[1], 0}));
}

TEST(Schema, KnowsWhatAFieldHolds) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const Field byte{.name = "", .type = Type::u8}, bits{.name = "", .type = Type::u8, .bit_shift = 3, .bit_width = 5};
  const Field grid{.name = "", .type = Type::i32, .scale = 0.01, .bias = 1000};
  const Field single{.name = "", .type = Type::f32}, wide{.name = "", .type = Type::i64};
  for (const double value : {-1.0, 256.0, nan, infinity}) EXPECT_FALSE(holds(byte, value)) << value;
  for (const double value : {0.0, 255.0, 254.6}) EXPECT_TRUE(holds(byte, value)) << value;
  EXPECT_TRUE(holds(bits, 31));
  EXPECT_FALSE(holds(bits, 32));
  EXPECT_TRUE(holds(grid, 1000 + 21474836.47));
  EXPECT_FALSE(holds(grid, 1000 + 21474836.48));
  EXPECT_FALSE(holds(grid, nan));
  EXPECT_TRUE(holds(single, infinity));
  EXPECT_FALSE(holds(single, 1e39));
  EXPECT_FALSE(holds(wide, 0x1p63));
  EXPECT_TRUE(holds_all_of(single, grid));
  EXPECT_FALSE(holds_all_of(single, {.name = "", .type = Type::f64}));
  EXPECT_TRUE(holds_all_of(byte, bits));
  EXPECT_FALSE(holds_all_of(bits, byte));
  EXPECT_FALSE(holds_all_of(byte, single));
}

}  // namespace
}  // namespace pointsweep
