// SPDX-License-Identifier: MIT
/// Rows past 2^32, in files of many gigabytes. The files are nearly all holes, so they take little room on the disk.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <span>

#include "pointsweep/formats/las/las_reader.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "pointsweep/formats/ply/ply_format.h"
#include "tests/formats/las_test_file.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kManyRows = 4'400'000'000, kFar = 4'300'000'000;  ///< the lower 32 bits of kFar are 5,032,704

/// Makes the file `size` bytes long and writes `bytes` at `offset`. Returns false if the file system cannot hold such a
/// hole.
bool grow_with_hole(const std::filesystem::path& path, std::uint64_t size, std::uint64_t offset,
                    const std::string& bytes) {
  std::error_code error;
  std::filesystem::resize_file(path, size, error);
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(offset));
  file << bytes;
  return !error && file.flush().good();
}

std::vector<std::byte> rows_of(Reader& reader, std::uint64_t first, std::size_t rows) {
  std::vector<std::byte> records(rows * reader.info().schema.stride);
  EXPECT_EQ(reader.read(first, records), rows);
  return records;
}

/// Returns the path of the file that a writer has begun, the only file in the folder.
std::filesystem::path only_file_in(const TemporaryFolder& folder) {
  return std::filesystem::directory_iterator(folder.path())->path();
}

std::string bytes_at(const std::filesystem::path& path, std::uint64_t offset, std::size_t count) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(count, '?');
  file.seekg(static_cast<std::streamoff>(offset));
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  return bytes;
}

TEST(ManyRows, OfPlyAreReadPastFourBillion) {
  const TemporaryFolder folder;
  const std::string header = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty uchar x\nproperty uchar y\nproperty uchar z\n"
      "end_header\n",
      kManyRows);
  const auto path = folder.write("in.ply", header);
  if (!grow_with_hole(path, header.size() + 3 * kManyRows, header.size() + 3 * kFar, "abc"))
    GTEST_SKIP() << "the temporary folder takes no file of 13 GB, all holes";
  const auto reader = open_ply(path);
  ASSERT_EQ(reader->info().count, kManyRows);
  const auto records = rows_of(*reader, kFar - 1, 3);
  const unsigned char expected[] = {0, 0, 0, 'a', 'b', 'c', 0, 0, 0};
  ASSERT_EQ(records.size(), sizeof expected);
  EXPECT_EQ(std::memcmp(records.data(), expected, sizeof expected), 0);
  EXPECT_EQ(rows_of(*reader, kManyRows - 1, 1), std::vector<std::byte>(3));
}

TEST(ManyRows, OfLas14AreReadPastFourBillion) {
  const TemporaryFolder folder;
  las_test::File file;
  file.minor = 4, file.format = 6, file.count = 1;
  std::string bytes = file.bytes();
  const std::string record = bytes.substr(file.points_at());
  bytes.resize(file.points_at());
  las_test::put(bytes, 247, kManyRows);
  const auto path = folder.write("in.las", bytes);
  if (!grow_with_hole(path, bytes.size() + record.size() * kManyRows, bytes.size() + record.size() * kFar, record))
    GTEST_SKIP() << "the temporary folder takes no file of 132 GB, all holes";
  const auto reader = open_las(path);
  ASSERT_EQ(reader->info().count, kManyRows);
  const auto records = rows_of(*reader, kFar, 2);
  EXPECT_EQ(std::memcmp(records.data(), record.data(), 12), 0) << "x, y and z as they were put there";
  EXPECT_NE(std::memcmp(records.data() + records.size() / 2, record.data(), 12), 0) << "and not in the next row";
}

TEST(ManyRows, OfPlyAreWrittenPastFourBillion) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.ply", kManyRows);
  for (const char* name : {"x", "y", "z"}) plan.schema.append(name, Type::u8);
  const auto writer = create_ply_writer(plan);
  ASSERT_TRUE(writer->can_write_at());
  writer->write_at(kFar, std::as_bytes(std::span("abc", 3)));
  const auto path = only_file_in(folder);
  const std::string start = bytes_at(path, 0, 1000);
  EXPECT_NE(start.find("element vertex 4400000000\n"), std::string::npos);
  EXPECT_EQ(bytes_at(path, start.find("end_header\n") + 11 + 3 * kFar, 3), "abc");
}

TEST(ManyRows, OfArraysAreWrittenPastFourBillion) {
  const TemporaryFolder folder;
  OutputPlan plan = plan_for(folder / "out.npy", kManyRows);
  plan.schema.append("neighbors", Type::u64, 2);
  const auto writer = create_npy_writer(plan);
  const std::uint64_t neighbors[] = {kFar - 1, kFar + 1};
  writer->write_at(kFar, std::as_bytes(std::span(neighbors)));
  const auto path = only_file_in(folder);
  const std::string start = bytes_at(path, 0, 128);
  EXPECT_NE(start.find("'<u8', 'fortran_order': False, 'shape': (4400000000, 2)"), std::string::npos);
  EXPECT_EQ(bytes_at(path, start.find('\n') + 1 + 16 * kFar, 16),
            std::string(reinterpret_cast<const char*>(neighbors), 16));
}

}  // namespace
}  // namespace pointsweep
