// SPDX-License-Identifier: MIT
/// Files that all threads encode and write have the bytes, and the errors, of one thread.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pointsweep/error.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/threads.h"
#include "pointsweep/writer.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kWrittenRows = 60000;  // several blocks of every writer

OutputPlan plan_of_cloud(const std::filesystem::path& path, std::uint64_t count) {
  OutputPlan plan = plan_for(path, count);
  for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::f64);
  plan.schema.append("intensity", Type::u16);
  plan.bounds = Box{{0, 0, 0}, {1e3, 1e3, 1e3}};
  return plan;
}

std::vector<std::byte> records_of_cloud(const Schema& schema, std::uint64_t count) {
  std::vector<std::byte> records(count * schema.stride);
  for (std::uint64_t row = 0; row < count; ++row)
    for (std::size_t f = 0; f < schema.fields.size(); ++f)
      set_value(schema.fields[f], records.data() + row * schema.stride,
                std::fmod(static_cast<double>(row * (f + 1)) * 0.618, 1000));
  return records;
}

TEST(ParallelWriters, WriteTheBytesOfOneThread) {
  const TemporaryFolder folder;
  for (const char* const name : {"a.ply", "a.las", "a.laz", "a.pcd"}) {
    if (!format_of_output(name)->is_built_in()) continue;
    std::string of_one;
    for (const unsigned threads : {1u, 2u, 8u}) {
      const OutputPlan plan = plan_of_cloud(folder / fmt::format("{}{}", threads, name), kWrittenRows);
      with_threads(threads, [&] { write_all(plan, records_of_cloud(plan.schema, kWrittenRows)); });
      const std::string bytes = contents(plan.path);
      if (threads == 1) of_one = bytes;
      EXPECT_TRUE(bytes == of_one) << name << ", " << threads << " threads";
    }
  }
}

TEST(ParallelWriters, NameTheFirstRowThatLasCannotHold) {
  const TemporaryFolder folder;
  for (const char* const name : {"a.las", "a.laz"}) {
    if (!format_of_output(name)->is_built_in()) continue;
    const OutputPlan plan = plan_of_cloud(folder / name, kWrittenRows);
    std::vector<std::byte> records = records_of_cloud(plan.schema, kWrittenRows);
    for (const std::uint64_t row : {59999u, 42000u, 31111u})
      set_value(plan.schema.fields[1], records.data() + row * plan.schema.stride, std::nan(""));
    with_threads(8, [&] {
      for (int repeat = 0; repeat < 20; ++repeat) try {
          create_writer(plan)->write(records);
          ADD_FAILURE();
        } catch (const Error& error) {
          EXPECT_THAT(error.what(), testing::HasSubstr("y of row 31111 is nan"));
        }
    });
  }
}

/// The writer collects as many chunks as it compresses at once. Until then it writes no bytes.
TEST(ParallelWriters, CompressAsManyChunksAtOnceAsTheirMemoryHolds) {
  if (!format_of_output("a.laz")->is_built_in()) GTEST_SKIP() << "built without LASzip";
  constexpr std::uint64_t kChunk = 50000;
  const TemporaryFolder folder;
  for (const auto& [memory, chunks] : {std::pair(std::uint64_t{0}, 4u), std::pair(std::uint64_t{1} << 30, 6u)}) {
    OutputPlan plan = plan_of_cloud(folder / "a.laz", 7 * kChunk);
    plan.encoder_bytes = memory;
    const std::vector<std::byte> chunk = records_of_cloud(plan.schema, kChunk);
    with_threads(6, [&] {
      const auto writer = create_writer(plan);
      const std::uint64_t before = writer->bytes_written();
      for (unsigned c = 1; c < chunks; ++c) {
        writer->write(chunk);
        EXPECT_EQ(writer->bytes_written(), before) << c;
      }
      writer->write(chunk);
      EXPECT_GT(writer->bytes_written(), before);
    });
  }
}

}  // namespace
}  // namespace pointsweep
