// SPDX-License-Identifier: MIT
/// Reading by chunks: laws for every reader with decoders.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <thread>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/rows/input_source.h"
#include "pointsweep/reader.h"
#include "tests/formats/point_files.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kRows = 70000;  // several chunks of each format

/// Returns records of x, y, z and intensity whose values identify the row.
std::vector<std::byte> rows_of_values(const Schema& schema, std::uint64_t count) {
  std::vector<std::byte> records(count * schema.stride);
  for (std::uint64_t row = 0; row < count; ++row)
    for (std::size_t f = 0; f < schema.fields.size(); ++f)
      set_value(schema.fields[f], records.data() + row * schema.stride,
                static_cast<double>(row) + static_cast<double>(f) * 0.25);
  return records;
}

OutputPlan plan_of_rows(const std::filesystem::path& path, std::uint64_t count) {
  OutputPlan plan = plan_for(path, count);
  for (const char* name : {"x", "y", "z", "quality"}) plan.schema.append(name, Type::f64);
  plan.bounds.emplace();
  plan.bounds->include(Vec3{});
  plan.bounds->include(Vec3{1e5, 1e5, 1e5});
  return plan;
}

/// Adds files that the library does not write: PTX with empty cells, VTK in text and binary, an array in Fortran order.
void add_files_of_other_programs(const TemporaryFolder& folder, const std::string& lines,
                                 std::vector<std::filesystem::path>& paths) {
  const std::string ptx = "1\n70002\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  paths.push_back(folder.write("a.ptx", ptx + "0 0 0 0.5\n" + lines + "0 0 0 0.5\n"));
  std::string points, quality, array;
  std::vector<float> columns[3];
  for (std::uint64_t row = 0; row < kRows; ++row) {
    points += fmt::format("{0} {0}.25 {0}.5\n", row);
    quality += fmt::format("{}.75 ", row);
    for (std::size_t axis = 0; axis < 3; ++axis) columns[axis].push_back(static_cast<float>(row + axis));
  }
  paths.push_back(
      folder.write("text.vtk", "# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 70000 double\n" + points +
                                   "POINT_DATA 70000\nSCALARS quality float\nLOOKUP_TABLE default\n" + quality));
  for (const auto& column : columns)
    array.append(reinterpret_cast<const char*>(column.data()), column.size() * sizeof(float));
  paths.push_back(folder.write(
      "binary.vtk", "# vtk DataFile Version 3.0\n\nBINARY\nDATASET POLYDATA\nPOINTS 70000 float\n" + array +
                        "\nPOINT_DATA 70000\nSCALARS id int\nLOOKUP_TABLE default\n" + array.substr(0, 4 * kRows)));
  const std::string dictionary = "{'descr': '<f4', 'fortran_order': True, 'shape': (70000, 3)}";
  const std::string npy = std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(dictionary.size()) + '\0';
  paths.push_back(folder.write("fortran.npy", npy + dictionary + array));
}

/// Writes a file in each format that stores rows in its own way, and returns their paths.
std::vector<std::filesystem::path> files(const TemporaryFolder& folder) {
  std::vector<std::filesystem::path> paths;
  for (const char* name : {"a.ply", "a.las", "a.laz", "a.pcd", "a.xyz", "a.csv"}) {
    if (!format_of_output(name)->is_built_in()) continue;
    const OutputPlan plan = plan_of_rows(folder / name, kRows);
    write_all(plan, rows_of_values(plan.schema, kRows));
    paths.push_back(plan.path);
  }
  std::string ply = "ply\nformat ascii 1.0\nelement vertex 70000\n", pcd = "VERSION 0.7\nFIELDS x y z q\n";
  for (const char* name : {"x", "y", "z", "q"}) ply += std::string("property double ") + name + "\n";
  pcd += "SIZE 8 8 8 8\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 70000\nHEIGHT 1\nPOINTS 70000\nDATA ascii\n";
  std::string lines;
  for (std::uint64_t row = 0; row < kRows; ++row) lines += fmt::format("{0} {0}.25 {0}.5 {0}.75\n", row);
  paths.push_back(folder.write("ascii.ply", ply + "end_header\n" + lines));
  paths.push_back(folder.write("ascii.pcd", pcd + lines));
  add_files_of_other_programs(folder, lines, paths);
  return paths;
}

TEST(Chunks, FollowEachOtherFromTheFirstRowToTheLast) {
  const TemporaryFolder folder;
  for (const auto& path : files(folder)) {
    SCOPED_TRACE(path.filename());
    const auto reader = open_reader(path);
    std::uint64_t row = 0, byte = 0, chunks = 0;
    for (; row < kRows; ++chunks) {
      const Chunk chunk = reader->chunk_of(row);
      EXPECT_EQ(chunk.first_row, row);
      ASSERT_GT(chunk.rows, 0u);
      EXPECT_GE(chunk.begin, byte);
      EXPECT_LE(chunk.end, reader->info().bytes);
      EXPECT_EQ(reader->chunk_of(chunk.end_row() - 1).first_row, row);
      row = chunk.end_row();
      byte = chunk.end;
    }
    EXPECT_EQ(row, kRows);
    EXPECT_GT(chunks, 1u);
  }
}

TEST(Chunks, AreDecodedByManyThreadsAtOnceAsByOne) {
  const TemporaryFolder folder;
  for (const auto& path : files(folder)) {
    SCOPED_TRACE(path.filename());
    const auto reader = open_reader(path);
    const std::vector<std::byte> expected = all_records(*reader);
    const std::size_t stride = reader->info().schema.stride;
    std::vector<std::byte> decoded(expected.size());
    std::vector<std::thread> threads;
    for (std::uint64_t begin = 0; begin < kRows; begin = reader->chunk_of(begin).end_row())
      threads.emplace_back([&, begin] {
        const auto decoder = reader->decoder();
        const std::uint64_t end = reader->chunk_of(begin).end_row();
        for (std::uint64_t row = begin; row < end;) {
          const std::size_t n = std::min<std::uint64_t>(1000, end - row);
          row += decoder->read(row, std::span(decoded).subspan(row * stride, n * stride));
        }
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(decoded, expected);
  }
}

TEST(Chunks, ADecoderJumpsToAnyRow) {
  const TemporaryFolder folder;
  for (const auto& path : files(folder)) {
    SCOPED_TRACE(path.filename());
    const auto reader = open_reader(path);
    const std::vector<std::byte> expected = all_records(*reader);
    const std::size_t stride = reader->info().schema.stride;
    const auto decoder = reader->decoder();
    std::vector<std::byte> records(3 * stride);
    for (const std::uint64_t row : {69999u, 0u, 40000u, 40003u, 40001u, 16383u, 69998u}) {
      const std::size_t n = decoder->read(row, records);
      ASSERT_EQ(n, std::min<std::uint64_t>(3, kRows - row));
      EXPECT_EQ(std::memcmp(records.data(), expected.data() + row * stride, n * stride), 0) << row;
    }
    EXPECT_EQ(decoder->read(kRows, records), 0u);
  }
}

std::vector<std::byte> decoded_in_parallel(InputCloud& cloud) {
  ParallelRows rows(source_of(cloud));
  const std::size_t stride = cloud.schema().stride;
  std::vector<std::byte> decoded(cloud.count() * stride);
  for (std::uint64_t row = 0; row < cloud.count(); row += 33333) {
    const std::size_t n = std::min<std::uint64_t>(33333, cloud.count() - row);
    rows.read(row, std::span(decoded).subspan(row * stride, n * stride));
  }
  return decoded;
}

/// The inputs have different schemas, so that records are converted. Each format comes before and after two others.
TEST(Chunks, OfSeveralInputsAreDecodedInParallelAsInTurn) {
  const TemporaryFolder folder;
  const auto paths = files(folder);
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (const std::size_t apart : {1u, 4u}) {
      const auto &first = paths[i], &second = paths[(i + apart) % paths.size()];
      SCOPED_TRACE(fmt::format("{} {}", first.filename().string(), second.filename().string()));
      InputCloud cloud({first, second});
      const std::vector<std::byte> expected = all_records(cloud, cloud.schema(), cloud.count(), 5000);
      EXPECT_EQ(decoded_in_parallel(cloud), expected);
    }
}

/// Returns whether a selection with whole, empty and mixed blocks has the row.
bool stays(std::uint64_t row) { return row < 9000 || (row > 22000 && row % 3 == 1 && row % 20000 < 15000); }

void select_some_rows(InputCloud& cloud) {
  cloud = cloud.selected(
      RowSelection(cloud.count(), [rows = cloud.count()](std::uint64_t block, std::span<std::byte> bits) {
        std::ranges::fill(bits, std::byte{});
        const std::uint64_t first = block * RowSelection::kBlockRows;
        for (std::uint64_t i = 0; i < RowSelection::kBlockRows && first + i < rows; ++i)
          if (stays(first + i)) bits[i / 8] |= std::byte{1} << (i % 8);
      }));
}

TEST(Chunks, OfSelectedRowsAreDecodedInParallel) {
  const TemporaryFolder folder;
  for (const auto& path : files(folder)) {
    SCOPED_TRACE(path.filename());
    InputCloud cloud({path});
    const std::size_t stride = cloud.schema().stride;
    const std::vector<std::byte> all = all_records(cloud, cloud.schema(), cloud.count());
    std::vector<std::byte> expected;
    for (std::uint64_t row = 0; row < kRows; ++row)
      if (stays(row)) expected.insert(expected.end(), all.data() + row * stride, all.data() + (row + 1) * stride);
    select_some_rows(cloud);
    EXPECT_NE(cloud.decoder(), nullptr);
    EXPECT_EQ(decoded_in_parallel(cloud), expected);
    EXPECT_EQ(all_records(cloud, cloud.schema(), cloud.count(), 777), expected);
  }
}

/// Text and binary files have some points whose coordinates are not finite, also where a chunk begins.
TEST(Chunks, WithoutNonfiniteRowsAreDecodedInParallel) {
  const TemporaryFolder folder;
  std::string text = "ply\nformat ascii 1.0\nelement vertex 70000\n", finite;
  for (const char* name : {"x", "y", "z"}) text += std::string("property float ") + name + "\n";
  text += "end_header\n";
  std::vector<float> rows;
  for (std::uint64_t row = 0; row < kRows; ++row) {
    const bool lost = row % 10007 == 0 || (row > 30000 && row < 39000 && row % 2 == 0) || row == 16384;
    text += lost ? fmt::format("nan {0} {0}\n", row) : fmt::format("{0} 1 2\n", row);
    if (!lost) rows.insert(rows.end(), {static_cast<float>(row), 1, 2});
  }
  const auto ascii = folder.write("nan.ply", text);
  const OutputPlan plan = plan_for(folder / "binary.ply", kRows);
  InputCloud as_text({ascii});
  OutputPlan binary = plan;
  binary.schema = as_text.schema();
  write_all(binary, all_records(as_text, as_text.schema(), kRows));
  for (const auto& path : {ascii, binary.path}) {
    SCOPED_TRACE(path.filename());
    auto [cloud, dropped] = InputCloud({path}).finite();
    EXPECT_EQ(dropped.count, kRows - rows.size() / 3);
    EXPECT_NE(cloud.decoder(), nullptr);
    const auto bytes = std::as_bytes(std::span(rows));
    EXPECT_EQ(decoded_in_parallel(cloud), std::vector<std::byte>(bytes.begin(), bytes.end()));
    for (std::uint64_t row = 0; row < cloud.count() && !cloud.readers().front()->decodes_any_range();) {
      const Chunk chunk = cloud.readers().front()->chunk_of(row);
      EXPECT_EQ(chunk.first_row, row);
      ASSERT_GT(chunk.rows, 0u);
      row = chunk.end_row();
    }
  }
}

}  // namespace
}  // namespace pointsweep
