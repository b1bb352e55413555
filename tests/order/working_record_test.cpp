// SPDX-License-Identifier: MIT
#include "pointsweep/order/working_record.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

/// Returns a schema like that of LAS: scaled integers, bits that share a byte, unnamed bytes.
Schema las_like() {
  Schema schema;
  schema.append("X", Type::i32);
  schema.append("Y", Type::i32);
  schema.append("Z", Type::i32);
  schema.append("intensity", Type::u16);
  schema.append("return_number", Type::u8);
  schema.append("extra", Type::f64, 2);
  schema.fields[0].scale = 0.001;
  schema.fields[0].bias = 5e5;
  schema.fields[4].bit_width = 4;
  schema.stride += 3;
  return schema;
}

std::vector<std::byte> some_records(std::size_t stride, std::size_t count) {
  std::vector<std::byte> bytes(stride * count);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 197 >> 3);
  return bytes;
}

TEST(WorkingRecord, CarriesPositionPayloadAndRow) {
  const Schema source = las_like();
  const std::vector<std::size_t> payload = {5, 0, 4};  // the position is carried anyway
  const WorkingRecord record(source, false, payload, 1000);
  const Schema& schema = record.schema();
  ASSERT_EQ(schema.fields.size(), 6u);
  EXPECT_EQ(schema.stride, 12u + 16 + 1 + 4);
  EXPECT_EQ(schema.fields[0].scale, 0.001);
  EXPECT_EQ(schema.fields[0].bias, 5e5);
  EXPECT_EQ(schema.fields[4].bit_width, 4);
  EXPECT_EQ(schema.fields[5].name, "row");

  const auto from = some_records(source.stride, 3);
  std::vector<std::byte> to(3 * schema.stride);
  const std::uint32_t place[] = {2, 0, 1};
  record.scatter(from.data(), source.stride, 3, 500, place, to.data());
  const std::size_t kept[] = {0, 1, 2, 5, 4};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::byte* made = &to[place[i] * schema.stride];
    for (std::size_t f = 0; f < std::size(kept); ++f) {
      const Field& field = source.fields[kept[f]];
      EXPECT_EQ(std::memcmp(made + schema.fields[f].offset, &from[i * source.stride + field.offset],
                            size_of(field.type) * field.count),
                0);
    }
    EXPECT_EQ(row_of(schema, made), 500 + i);
  }
}

TEST(WorkingRecord, MayBeTheWholeRecordWithUnnamedBytes) {
  const Schema source = las_like();
  const WorkingRecord record(source, true, {}, 1000);
  EXPECT_EQ(record.schema().stride, source.stride + 4);
  const auto from = some_records(source.stride, 1);
  std::vector<std::byte> to(record.schema().stride);
  const std::uint32_t place = 0;
  record.scatter(from.data(), source.stride, 1, 7, &place, to.data());
  EXPECT_TRUE(std::equal(from.begin(), from.end(), to.begin()));
  EXPECT_EQ(row_of(record.schema(), to.data()), 7u);
}

TEST(WorkingRecord, HasRowsOf64BitsWhereTheyAreNeeded) {
  const Schema source = las_like();
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  EXPECT_EQ(WorkingRecord(source, false, {}, kMost).schema().fields.back().type, Type::u32);
  const WorkingRecord record(source, false, {}, kMost + 1);
  EXPECT_EQ(record.schema().fields.back().type, Type::u64);
  const auto from = some_records(source.stride, 1);
  std::vector<std::byte> to(record.schema().stride);
  const std::uint32_t place = 0;
  record.scatter(from.data(), source.stride, 1, 10'000'000'000, &place, to.data());
  EXPECT_EQ(row_of(record.schema(), to.data()), 10'000'000'000u);
}

TEST(WorkingRecord, OfPointsWithoutAPositionIsRefused) {
  Schema schema;
  schema.append("x", Type::f32);
  EXPECT_THROW(WorkingRecord(schema, false, {}, 1), Error);
}

}  // namespace
}  // namespace pointsweep
