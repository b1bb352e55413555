// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <thread>

#include "pointsweep/error.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A reader of records in memory with any schema.
class MemoryReader final : public Reader {
 public:
  MemoryReader(Schema schema, std::vector<std::vector<double>> rows, std::optional<Box> bounds = {}) {
    info_.path = "memory";
    info_.schema = std::move(schema);
    info_.count = rows.size();
    info_.bytes = rows.size();
    info_.bounds = bounds;
    records_.resize(rows.size() * info_.schema.stride);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t f = 0; f < rows[i].size(); ++f) {
        set_value(info_.schema.fields[f], records_.data() + i * info_.schema.stride, rows[i][f]);
      }
    }
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t stride = info_.schema.stride;
    const std::size_t rows = std::min<std::size_t>(info_.count - row, records.size() / stride);
    std::memcpy(records.data(), records_.data() + row * stride, rows * stride);
    return rows;
  }

  /// Sets all bits of a value of 64 bits.
  void set_bits(std::size_t row, std::size_t field, std::uint64_t bits) {
    const std::size_t at = row * info_.schema.stride + info_.schema.fields[field].offset;
    std::memcpy(records_.data() + at, &bits, sizeof bits);
  }

 private:
  std::vector<std::byte> records_;
};

Schema schema_of(std::vector<std::pair<std::string, Type>> fields) {
  Schema schema;
  for (const auto& [name, type] : fields) schema.append(name, type);
  return schema;
}

Schema grid(double scale, std::array<double, 3> bias) {
  Schema schema = schema_of({{"x", Type::i32}, {"y", Type::i32}, {"z", Type::i32}, {"intensity", Type::u16}});
  for (std::size_t i = 0; i < 3; ++i) {
    schema.fields[i].scale = scale;
    schema.fields[i].bias = bias[i];
  }
  schema.stride += 3;
  return schema;
}

template <class... Readers>
InputCloud cloud_of(Readers... readers) {
  std::vector<std::unique_ptr<Reader>> list;
  (list.push_back(std::make_unique<MemoryReader>(std::move(readers))), ...);
  return InputCloud(std::move(list));
}

std::vector<double> values_of(InputCloud& cloud, const std::string& name) {
  return values_of(cloud, cloud.schema(), cloud.count(), name);
}

TEST(InputCloud, RowsRunThroughTheInputsInOrder) {
  const Schema schema = schema_of({{"x", Type::f32}, {"y", Type::f32}, {"z", Type::f32}});
  InputCloud cloud = cloud_of(MemoryReader(schema, {{1, 0, 0}, {2, 0, 0}}), MemoryReader(schema, {}),
                              MemoryReader(schema, {{3, 0, 0}}), MemoryReader(schema, {}));
  EXPECT_EQ(cloud.count(), 3u);
  EXPECT_EQ(cloud.bytes(), 3u);
  EXPECT_EQ(cloud.schema(), schema);
  EXPECT_THAT(values_of(cloud, "x"), ElementsAre(1, 2, 3));
  std::vector<std::byte> records(10 * schema.stride);
  EXPECT_EQ(cloud.read(1, records), 2u);
  EXPECT_EQ(value_of(schema.fields[0], records.data()), 2);
  EXPECT_EQ(cloud.read(3, records), 0u);
}

TEST(InputCloud, NoInputIsAUsageError) { EXPECT_THROW(InputCloud(std::vector<std::filesystem::path>{}), UsageError); }

TEST(InputCloud, UnitesFieldsByMeaningAndFillsWithZeros) {
  InputCloud cloud = cloud_of(
      MemoryReader(schema_of({{"x", Type::f32}, {"y", Type::f32}, {"z", Type::f32}, {"nx", Type::f32}}),
                   {{1, 2, 3, 4}}),
      MemoryReader(
          schema_of({{"NormalX", Type::f64}, {"id", Type::i64}, {"Z", Type::f32}, {"Y", Type::f32}, {"X", Type::f32}}),
          {{0.1, 7, 6, 5, 4}}));
  EXPECT_THAT(field_names(cloud.schema()), ElementsAre("x", "y", "z", "nx", "id"));
  EXPECT_EQ(cloud.schema().fields[0].type, Type::f32);
  EXPECT_EQ(cloud.schema().fields[3].type, Type::f64);
  EXPECT_THAT(values_of(cloud, "x"), ElementsAre(1, 4));
  EXPECT_THAT(values_of(cloud, "z"), ElementsAre(3, 6));
  EXPECT_THAT(values_of(cloud, "nx"), ElementsAre(4, 0.1));
  EXPECT_THAT(values_of(cloud, "id"), ElementsAre(0, 7));
}

TEST(InputCloud, SaysWhichInputLacksWhatAnotherHas) {
  const Schema plain = schema_of({{"x", Type::f32}, {"y", Type::f32}, {"z", Type::f32}});
  Schema more = plain, other = plain;
  more.append("nx", Type::f32);
  more.append("gain", Type::f32);
  other.append("NormalX", Type::f32);
  const auto warnings_of = [](std::vector<Schema> schemas) {
    std::vector<std::unique_ptr<Reader>> readers;
    for (Schema& schema : schemas)
      readers.push_back(std::make_unique<MemoryReader>(std::move(schema), std::vector<std::vector<double>>{}));
    return InputCloud(std::move(readers)).warnings();
  };
  EXPECT_TRUE(warnings_of({plain, plain}).empty());
  EXPECT_THAT(warnings_of({more, plain}),
              ElementsAre("memory: has no 'nx', 'gain', which memory and others have; they are 0 for its points."));
  EXPECT_THAT(warnings_of({other, more}),
              ElementsAre("memory: has no 'gain', which memory has; it is 0 for its points."));
  EXPECT_EQ(warnings_of({more, plain, plain, plain, plain, plain, plain, plain}).size(), 6u);
}

TEST(InputCloud, CoordinatesOfDifferentTypesBecomeDouble) {
  const std::vector<std::pair<std::string, Type>> xy{{"x", Type::f32}, {"y", Type::f32}};
  InputCloud cloud =
      cloud_of(MemoryReader(schema_of({{"x", Type::f32}, {"y", Type::f32}, {"z", Type::f32}}), {{1, 2, 0.1}}),
               MemoryReader(schema_of({{"x", Type::f64}, {"y", Type::i32}, {"z", Type::u8}}), {{0.1, 1 << 30, 9}}));
  EXPECT_EQ(cloud.schema().fields[0].type, Type::f64);
  EXPECT_EQ(cloud.schema().fields[1].type, Type::f64);
  EXPECT_EQ(cloud.schema().fields[2].type, Type::f32);
  EXPECT_THAT(values_of(cloud, "x"), ElementsAre(1, 0.1));
  EXPECT_THAT(values_of(cloud, "y"), ElementsAre(2, 1 << 30));
  EXPECT_THAT(values_of(cloud, "z"), ElementsAre(0.1f, 9));
}

TEST(InputCloud, IntegersOfDifferentTypesBecomeTheSmallestThatHoldsBoth) {
  const auto united = [](Type a, Type b) {
    const auto schema = [](Type type) {
      return schema_of({{"x", Type::f32}, {"y", Type::f32}, {"z", Type::f32}, {"i", type}});
    };
    return cloud_of(MemoryReader(schema(a), {}), MemoryReader(schema(b), {})).schema().fields[3].type;
  };
  EXPECT_EQ(united(Type::u8, Type::u16), Type::u16);
  EXPECT_EQ(united(Type::u8, Type::i8), Type::i16);
  EXPECT_EQ(united(Type::u32, Type::i8), Type::i64);
  EXPECT_EQ(united(Type::u16, Type::f32), Type::f32);
  EXPECT_EQ(united(Type::u32, Type::f32), Type::f64);
  EXPECT_EQ(united(Type::i64, Type::u64), Type::i64);
  EXPECT_EQ(united(Type::u64, Type::i8), Type::i64);
  EXPECT_EQ(united(Type::u64, Type::f32), Type::f64);
}

TEST(InputCloud, IntegersOf64BitsKeepTheirValuesOrAreRefused) {
  const auto cloud_with = [](Type type, std::uint64_t bits, Type other) {
    const auto reader = [](Type of_i) {
      return MemoryReader(schema_of({{"x", Type::f32}, {"y", Type::f32}, {"z", Type::f32}, {"i", of_i}}),
                          {{0, 0, 0, 0}, {0, 0, 0, 5}});
    };
    MemoryReader wide = reader(type);
    wide.set_bits(1, 3, bits);
    return cloud_of(reader(other), std::move(wide));
  };
  const auto read_value = [](InputCloud cloud) {
    const auto records = all_records(cloud, cloud.schema(), cloud.count());
    const Field& field = cloud.schema().fields[3];
    const std::byte* const last = records.data() + 3 * cloud.schema().stride;
    return has_whole_numbers(field) ? whole_number_of(field, last) : static_cast<std::int64_t>(value_of(field, last));
  };
  constexpr std::int64_t kOdd = (std::int64_t{1} << 53) + 1;
  for (const Type other : {Type::i8, Type::i32, Type::i64}) {
    EXPECT_EQ(read_value(cloud_with(Type::u64, kOdd, other)), kOdd);
    EXPECT_THAT(sentence_of<Error>([&] { read_value(cloud_with(Type::u64, std::uint64_t{1} << 63, other)); }),
                HasSubstr("memory: row 1: 'i' is 9223372036854775808"));
  }
  EXPECT_EQ(read_value(cloud_with(Type::i64, static_cast<std::uint64_t>(-kOdd), Type::u64)), -kOdd);
  for (const Type other : {Type::f32, Type::f64})
    for (const Type type : {Type::u64, Type::i64}) {
      EXPECT_EQ(read_value(cloud_with(type, kOdd + 1, other)), kOdd + 1);
      EXPECT_THAT(sentence_of<Error>([&] { read_value(cloud_with(type, kOdd, other)); }),
                  HasSubstr("memory: row 1: 'i' is 9007199254740993"));
      EXPECT_NO_THROW(read_value(cloud_with(type, kOdd, other).with_unused_attributes()));
    }
}

TEST(InputCloud, IntegerGridsWithOffsetsOfWholeStepsStayIntegers) {
  const Schema first = grid(0.01, {500000, 0, 0}), second = grid(0.01, {501000.5, 0, 100});
  InputCloud cloud = cloud_of(MemoryReader(first, {{500000.25, 1, 2, 3}}, Box{{500000, 0, 0}, {500001, 1, 2}}),
                              MemoryReader(second, {{501000.75, -4, 99, 5}}, Box{{501000, -4, 99}, {501001, 0, 100}}));
  EXPECT_EQ(cloud.schema(), first);
  EXPECT_THAT(values_of(cloud, "x"), ElementsAre(500000.25, 501000.75));
  EXPECT_THAT(values_of(cloud, "y"), ElementsAre(1, -4));
  EXPECT_THAT(values_of(cloud, "z"), ElementsAre(2, 99));
  EXPECT_THAT(values_of(cloud, "intensity"), ElementsAre(3, 5));
}

TEST(InputCloud, IntegerGridsOfOtherLayoutAreShiftedAndConverted) {
  const Schema first = grid(0.01, {0, 0, 0});
  Schema second = grid(0.01, {10, 0, 0});
  second.append("extra", Type::u8);
  InputCloud cloud = cloud_of(MemoryReader(first, {{1, 1, 1, 1}}, Box{{1, 1, 1}, {1, 1, 1}}),
                              MemoryReader(second, {{2, 2, 2, 2, 9}}, Box{{2, 2, 2}, {2, 2, 2}}));
  EXPECT_EQ(cloud.schema().fields[0].type, Type::i32);
  EXPECT_THAT(values_of(cloud, "x"), ElementsAre(1, 2));
  EXPECT_THAT(values_of(cloud, "extra"), ElementsAre(0, 9));
}

TEST(InputCloud, IntegerGridsWithOffsetsOfMoreThan32BitsOfStepsStayIntegers) {
  const Box box{{500000, 5000000, 0}, {500010, 5000010, 10}};
  const std::vector<std::vector<double>> rows{{500001.25, 5000002.75, 3, 1}};
  for (const bool turned : {false, true}) {
    MemoryReader fine(grid(0.001, {500000, 5000000, 0}), rows, box), coarse(grid(0.01, {0, 0, 0}), rows, box);
    InputCloud cloud = turned ? cloud_of(coarse, fine) : cloud_of(fine, coarse);
    EXPECT_EQ(cloud.schema().fields[1].type, Type::i32);
    EXPECT_EQ(cloud.schema().fields[1].scale, 0.001);
    EXPECT_THAT(values_of(cloud, "x"), ElementsAre(500001.25, 500001.25));
    EXPECT_THAT(values_of(cloud, "y"), ElementsAre(5000002.75, 5000002.75));
  }
}

TEST(InputCloud, IntegerGridsThatDoNotAgreeBecomeDouble) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const Schema first = grid(0.01, {0, 0, 0});
  const auto type_with = [&](double scale, double bias, Box bounds) {
    return cloud_of(MemoryReader(first, {}, box), MemoryReader(grid(scale, {bias, 0, 0}), {}, bounds))
        .schema()
        .fields[0]
        .type;
  };
  EXPECT_EQ(type_with(0.01, 1, box), Type::i32);
  EXPECT_EQ(type_with(0.001, 0, box), Type::i32);
  EXPECT_EQ(type_with(0.003, 0, box), Type::f64);
  EXPECT_EQ(type_with(0.01, 0.005, box), Type::f64);
  EXPECT_EQ(type_with(0.01, 3e7, Box{{3e7, 0, 0}, {3e7, 1, 1}}), Type::i32) << "from an offset in the middle";
  EXPECT_EQ(type_with(0.01, 9e7, Box{{9e7, 0, 0}, {9e7, 1, 1}}), Type::f64);
}

TEST(InputCloud, BoundsThatLieDoNotWrapCoordinatesAround) {
  const Box box{{0, 0, 0}, {1, 1, 1}};
  InputCloud cloud = cloud_of(MemoryReader(grid(0.01, {0, 0, 0}), {}, box),
                              MemoryReader(grid(0.01, {1000, 0, 0}), {{21475500, 0, 0, 0}}, box));
  EXPECT_THAT(sentence_of<Error>([&] { values_of(cloud, "x"); }), HasSubstr("far outside the bounds in its header"));
}

TEST(InputCloud, BitFieldsOfDifferentLayoutsGetAWordOfTheirOwn) {
  Schema first = schema_of({{"x", Type::f32}, {"y", Type::f32}, {"z", Type::f32}, {"return_number", Type::u8}});
  Schema second = first;
  first.fields[3].bit_width = 3;
  second.fields[3].bit_width = 4;
  second.fields[3].bit_shift = 4;
  InputCloud cloud = cloud_of(MemoryReader(first, {{0, 0, 0, 7}}), MemoryReader(second, {{0, 0, 0, 13}}));
  EXPECT_TRUE(cloud.schema().fields[3].is_plain());
  EXPECT_THAT(values_of(cloud, "return_number"), ElementsAre(7, 13));
}

TEST(InputCloud, ReadsFilesOfDifferentFormatsAsOne) {
  const TemporaryFolder folder;
  folder.write("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
               "property uchar red\nend_header\n1 2 3 4\n");
  folder.write("b.csv", "x,y,z,r\n5,6,7,8\n9,10,11,12\n");
  InputCloud cloud(std::vector{folder / "a.ply", folder / "b.csv"});
  EXPECT_THAT(values_of(cloud, "x"), ElementsAre(1, 5, 9));
  EXPECT_THAT(values_of(cloud, "red"), ElementsAre(4, 8, 12));
  EXPECT_EQ(cloud.bytes(), std::filesystem::file_size(folder / "a.ply") + std::filesystem::file_size(folder / "b.csv"));
  EXPECT_NE(cloud.extras(), nullptr);
}

TEST(InputCloud, NoticesAnInputThatIsWrittenToButNotOneThatIsReplaced) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.xyz", "1 2 3\n4 5 6\n");
  const auto wait_for_the_clock_of_the_disk = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
  wait_for_the_clock_of_the_disk();
  const InputCloud cloud({path});
  EXPECT_NO_THROW(cloud.require_unchanged());
  std::filesystem::rename(folder.write("b.xyz", "7 8 9\n"), path);
  EXPECT_NO_THROW(cloud.require_unchanged());
  const InputCloud other({path});
  wait_for_the_clock_of_the_disk();
  folder.write("a.xyz", "7 8 0\n");
  EXPECT_THAT(sentence_of<Error>([&] { other.require_unchanged(); }), HasSubstr("was written to while it was read"));
}

}  // namespace
}  // namespace pointsweep
