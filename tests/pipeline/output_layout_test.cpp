// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/output_layout.h"

#include <gtest/gtest.h>

#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pointsweep {
namespace {

/// Returns a schema with attributes before, between and after the positions, bits that share a byte, and a gap at the
/// end.
Schema mixed_input(Type position) {
  Schema schema;
  schema.append("intensity", Type::u16);
  schema.append("X", position);
  schema.append("flags", Type::u8);
  schema.fields.back().bit_width = 3;
  Field rest = schema.fields.back();
  rest.name = "rest", rest.bit_shift = 3, rest.bit_width = 5;
  schema.fields.push_back(rest);
  schema.append("z", position);
  schema.append("y", position);
  schema.append("time", Type::f64, 2);
  schema.stride += 3;
  return schema;
}

const std::vector<std::pair<std::string, double>> kPassed{
    {"intensity", 777}, {"flags", 5}, {"rest", 19}, {"time", 123456789.125}};

std::vector<std::byte> input_record(const Schema& input) {
  std::vector<std::byte> record(input.stride);
  for (const auto& [name, value] : kPassed) set_value(input.fields[*input.find(name)], record.data(), value);
  set_value(input.fields[*input.find("time")], record.data(), -7.5, 1);
  for (const char* axis : {"x", "y", "z"}) set_value(input.fields[*input.find(axis)], record.data(), 1);
  return record;
}

/// Returns the output record of a point that was moved to (1/3, 2/3, 4/3) and has the normal (0, 0, 1).
std::vector<std::byte> assembled(const OutputLayout& layout, const std::vector<std::byte>& input) {
  struct {
    double position[3] = {1.0 / 3, 2.0 / 3, 4.0 / 3};
    float normal[3] = {0, 0, 1};
  } made;
  std::vector<std::byte> results(36), output(layout.schema().stride);
  std::memcpy(results.data(), made.position, 24);
  std::memcpy(results.data() + 24, made.normal, 12);
  layout.assemble(input.data(), results.data(), 1, output.data());
  return output;
}

double value(const OutputLayout& layout, const std::vector<std::byte>& record, const std::string& name) {
  return value_of(layout.schema().fields[*layout.schema().find(name)], record.data());
}

TEST(OutputLayout, MovedPositionsGetTheTypeAskedForWhereTheyStandAndAllElsePasses) {
  for (const Type from : {Type::f32, Type::f64, Type::i32}) {
    for (const Type to : {Type::f32, Type::f64}) {
      const Schema input = mixed_input(from);
      const OutputLayout layout(input, {position_attribute(), normal_attribute()}, {}, to);
      const std::vector<std::byte> record = assembled(layout, input_record(input));
      for (std::size_t f = 0; f < input.fields.size(); ++f)
        EXPECT_EQ(layout.schema().fields[f].name, input.fields[f].name);
      for (const auto& [name, expected] : kPassed) EXPECT_EQ(value(layout, record, name), expected) << name;
      EXPECT_EQ(value_of(layout.schema().fields[*layout.schema().find("time")], record.data(), 1), -7.5);
      const double third = to == Type::f64 ? 1.0 / 3 : double{1.0f / 3};
      EXPECT_EQ(value(layout, record, "x"), third);
      EXPECT_EQ(value(layout, record, "y"), to == Type::f64 ? 2.0 / 3 : double{float(2.0 / 3)});
      EXPECT_EQ(value(layout, record, "z"), to == Type::f64 ? 4.0 / 3 : double{float(4.0 / 3)});
      EXPECT_EQ(value(layout, record, "nz"), 1);
      EXPECT_EQ(layout.schema().stride, input.stride + 3 * size_of(to) - 3 * size_of(from) + 12);
    }
  }
}

/// The input has normals of another type, and an array after them, among other attributes.
TEST(OutputLayout, AnAttributeThatIsReplacedGetsTheTypeOfWhatIsMade) {
  for (const Type from : {Type::i8, Type::f64, Type::f32}) {
    Schema input = mixed_input(Type::f32);
    for (const char* name : {"ny", "nz"}) input.append(name, from);
    Field scaled = input.fields.back();
    scaled.name = "NormalX", scaled.type = Type::i16, scaled.scale = 0.5, scaled.offset = input.stride;
    input.fields.push_back(scaled);
    input.stride += 2;
    std::vector<std::size_t> all(input.fields.size());
    for (std::size_t f = 0; f < all.size(); ++f) all[f] = f;
    for (const bool kept : {false, true}) {
      const OutputLayout layout(input, {normal_attribute()},
                                {{"normal"}, {}, kept ? std::optional(all) : std::nullopt});
      const std::vector<std::byte> record = input_record(input);
      const float normal[3] = {0.25f, 1.0f / 3, -0.125f};
      std::vector<std::byte> results(12), output(layout.schema().stride);
      std::memcpy(results.data(), normal, 12);
      layout.assemble(record.data(), results.data(), 1, output.data());
      for (const auto& [name, expected] : kPassed) EXPECT_EQ(value(layout, output, name), expected) << name;
      EXPECT_EQ(value_of(layout.schema().fields[*layout.schema().find("time")], output.data(), 1), -7.5);
      EXPECT_EQ(value(layout, output, "z"), 1);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::string name = normal_attribute().fields[c];
        EXPECT_EQ(value(layout, output, name), double{normal[c]}) << name_of(from);
        EXPECT_EQ(layout.schema().fields[*layout.schema().find(name)].type, Type::f32);
      }
      EXPECT_EQ(layout.schema().fields.size(), input.fields.size());
    }
  }
}

TEST(OutputLayout, ACoordinateThatAStageMakesReplacesAScaledOneOfTheInput) {
  Schema input;
  for (const char* axis : {"x", "y", "z"}) input.fields[input.append(axis, Type::i32)].scale = 0.01;
  const OutputLayout layout(input, {scalar("x", Type::f64, "", "")});
  std::vector<std::byte> from(input.stride), output(layout.schema().stride);
  const double made = 7.25;
  layout.assemble(from.data(), reinterpret_cast<const std::byte*>(&made), 1, output.data());
  EXPECT_EQ(value(layout, output, "x"), 7.25);
}

TEST(OutputLayout, PositionsGetTheTypeAskedForWhetherTheyMoveOrNot) {
  const Schema input = mixed_input(Type::f32);
  const OutputLayout plain(input, {normal_attribute()}), still(input, {normal_attribute()}, {}, Type::f64);
  const OutputLayout moved(input, {position_attribute()}), rounded(input, {position_attribute()}, {}, Type::f32);
  for (const char* axis : {"x", "y", "z"}) {
    const std::size_t field = *input.find(axis);
    EXPECT_EQ(plain.schema().fields[field], input.fields[field]);
    EXPECT_EQ(still.schema().fields[field].type, Type::f64);
    EXPECT_EQ(moved.schema().fields[field].type, Type::f64) << "that of the attribute";
    EXPECT_EQ(rounded.schema().fields[field].type, Type::f32);
  }
}

}  // namespace
}  // namespace pointsweep
