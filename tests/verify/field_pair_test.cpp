// SPDX-License-Identifier: MIT
#include "pointsweep/verify/rows/field_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

#include "pointsweep/formats/format.h"

namespace pointsweep {
namespace {

Schema schema_of(const std::string& name, Type type, std::uint32_t count = 1) {
  Schema schema;
  schema.append(name, type, count);
  return schema;
}

/// Returns whether a copy `there` in a field of type `to` is accepted for the value `here` of type `from`.
bool passes(Type from, double here, Type to, double there, double scale = 1) {
  const Schema a = schema_of("v", from);
  Schema b = schema_of("v", to);
  b.fields[0].scale = scale;
  std::byte one[8]{}, other[8]{};
  set_value(a.fields[0], one, here);
  set_value(b.fields[0], other, there);
  const FieldPair pair = pairs_of_field(a, 0, b)->front();
  return pair.expected(one) == pair.found(other);
}

TEST(FieldPair, EqualTypesMustHaveEqualBits) {
  EXPECT_TRUE(passes(Type::f32, 0.1, Type::f32, 0.1));
  EXPECT_FALSE(passes(Type::f32, 0.1, Type::f32, std::nextafterf(0.1f, 1.0f)));
  EXPECT_FALSE(passes(Type::f64, 0.0, Type::f64, -0.0));
  EXPECT_TRUE(passes(Type::u16, 7, Type::u16, 7));
}

TEST(FieldPair, AValueHalfwayBetweenTwoStepsMayBecomeEither) {
  const Schema a = schema_of("v", Type::f64);
  Schema b = schema_of("v", Type::i32);
  b.fields[0].scale = 0.001;
  const FieldPair pair = pairs_of_field(a, 0, b)->front();
  std::byte stored[4]{};
  for (int i = 0; i < 2'000'000; i += 7) {
    const double value = i / 1000.0 + 0.0005, here = value + 495'000;
    set_value(b.fields[0], stored, i * 0.001 + 0.001);
    EXPECT_LE(std::abs(pair.found_value(stored) - value), pair.resolution(value)) << value;
    EXPECT_LT(pair.resolution(here), 0.0005001);
  }
}

TEST(FieldPair, AFloatInTextIsTheNearestFloat) {
  EXPECT_TRUE(passes(Type::f32, 0.1, Type::f64, 0.1));
  EXPECT_FALSE(passes(Type::f32, 0.1, Type::f64, 0.1000001));
  EXPECT_TRUE(passes(Type::f32, std::nan(""), Type::f64, std::nan("")));
}

TEST(FieldPair, StoredIntegersAreRoundedAndNeverSaturated) {
  EXPECT_TRUE(passes(Type::f64, 1.2345, Type::i32, 1.23, 0.01));
  EXPECT_FALSE(passes(Type::f64, 1.2345, Type::i32, 1.24, 0.01));
  EXPECT_FALSE(passes(Type::f32, 300, Type::u8, 255));
  EXPECT_FALSE(passes(Type::f64, 512000, Type::i32, 214748.3647, 0.0001));
  EXPECT_FALSE(passes(Type::f64, std::nan(""), Type::u8, 0));
  EXPECT_FALSE(passes(Type::f32, 200, Type::u8, 255));
}

TEST(FieldPair, IntegersOnADecimalGridMayBeTheDecimalFractions) {
  Schema grid = schema_of("x", Type::i32), text = schema_of("x", Type::f64);
  grid.fields[0].scale = 0.01;
  std::byte stored[4]{}, read[8]{};
  set_value(grid.fields[0], stored, 684992.57);
  ASSERT_NE(value_of(grid.fields[0], stored), 684992.57);
  const FieldPair pair = pairs_of_field(grid, 0, text)->front();
  for (const auto& [value, passes] : {std::pair{684992.57, true}, std::pair{684992.5700000001, true},
                                      std::pair{684992.58, false}, std::pair{684992.570001, false}}) {
    set_value(text.fields[0], read, value);
    EXPECT_EQ(pair.expected(stored) == pair.found(read), passes) << value;
  }
}

TEST(FieldPair, ColorsKeepTheirBrightness) {
  Schema bytes, words;
  for (const char* color : {"red", "green", "blue"}) bytes.append(color, Type::u8), words.append(color, Type::u16);
  std::byte narrow[3]{}, wide[6]{};
  set_value(bytes.fields[1], narrow, 77);
  for (const auto& [value, passes] : {std::pair{77.0 * 257, true}, std::pair{77.0, false}}) {
    set_value(words.fields[1], wide, value);
    const FieldPair widened = pairs_of_field(bytes, 1, words)->front();
    EXPECT_EQ(widened.expected(narrow) == widened.found(wide), passes) << value;
  }
}

TEST(FieldPair, FindsAFieldUnderTheNamesThatWritersGive) {
  const auto finds = [](const Schema& from, const std::string& name) {
    return pairs_of_field(from, 0, schema_of(name, Type::f32)).has_value();
  };
  EXPECT_TRUE(finds(schema_of("nx", Type::f32), "NormalX"));
  EXPECT_TRUE(finds(schema_of("Reflectance [dB]", Type::f32), "Reflectance_[dB]"));
  EXPECT_TRUE(finds(schema_of("a name longer than thirty-two bytes", Type::f32), "a name longer than thirty-two by"));
  EXPECT_TRUE(finds(schema_of("R", Type::f32), "red"));
  EXPECT_FALSE(finds(schema_of("nx", Type::f32), "ny"));
}

/// Where attributes get equal names, LAS renames the earlier ones and PCD the later ones.
TEST(FieldPair, FindsFieldsThatGotEqualNames) {
  const auto pairs = [](std::initializer_list<const char*> from, std::initializer_list<const char*> to,
                        StoredName stored_name) {
    Schema in, out;
    for (const char* name : from) in.append(name, Type::f64);
    for (const char* name : to) out.append(name, Type::f64);
    std::vector<std::string> found;
    for (std::size_t f = 0; f < in.fields.size(); ++f) {
      const auto pair = pairs_of_field(in, f, out, {}, stored_name);
      found.push_back(pair ? pair->front().name_in_output() : "none");
    }
    return found;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(pairs({"nx", "NormalX", "normal_x"}, {"NormalX", "normal_x", "NormalX_input"}, kLasFormat.stored_name),
            (Names{"NormalX_input", "NormalX", "normal_x"}));
  EXPECT_EQ(pairs({"nx", "NormalX", "normal_x"}, {"normal_x", "NormalX", "normal_x_2"}, kPcdFormat.stored_name),
            (Names{"normal_x", "NormalX", "normal_x_2"}));
  const std::string cut = "cut_to_its_first_32_characters_1";
  const std::string earlier = cut.substr(0, 26) + "_input", second = cut.substr(0, 26) + "_inp_2";
  EXPECT_EQ(pairs({(cut + "a").c_str(), (cut + "b").c_str(), (cut + "c").c_str()},
                  {earlier.c_str(), second.c_str(), cut.c_str()}, kLasFormat.stored_name),
            (Names{earlier, second, cut}));
}

TEST(FieldPair, FindsEveryComponentOrNothing) {
  const Schema from = schema_of("a", Type::f32, 2);
  Schema to = schema_of("a_0", Type::f32);
  EXPECT_FALSE(pairs_of_field(from, 0, to));
  to.append("a_1", Type::f32);
  EXPECT_EQ(pairs_of_field(from, 0, to)->size(), 2u);
  Schema las = schema_of("a[0]", Type::f32);
  las.append("a[1]", Type::f32);
  EXPECT_TRUE(pairs_of_field(from, 0, las));
}

TEST(FieldPair, AnExactCopyCountsRatherThanARoundedOne) {
  Schema to = schema_of("intensity", Type::u16);
  to.append("intensity_float32", Type::f32);
  const Schema from = schema_of("intensity", Type::f32);
  std::byte one[4]{}, other[6]{};
  set_value(from.fields[0], one, 0.5);
  const FieldPair pair = pairs_of_field(from, 0, to)->front();
  EXPECT_NE(pair.expected(one), pair.found(other));
  set_value(to.fields[1], other, 0.5);
  EXPECT_EQ(pair.expected(one), pair.found(other));
}

}  // namespace
}  // namespace pointsweep
