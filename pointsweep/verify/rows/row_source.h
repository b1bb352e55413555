// SPDX-License-Identifier: MIT
/// A source of rows, read in blocks and in sequence from a cloud or a single file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/geometry.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// A function called between pieces of work with the work done and the work in total; may throw to end the work.
using PhaseProgress = std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)>;

/// A file of a source. Its schema tells how the file stores values; records of the source may store them in another
/// way.
struct FileOfRows {
  std::uint64_t first;  ///< first row
  const Schema* schema;
};

class RowSource {
 public:
  /// Borrows the cloud or the reader.
  explicit RowSource(InputCloud& cloud);
  explicit RowSource(Reader& reader);
  /// `name`: name of all files together in messages. `left_out`: a field that the source hides.
  RowSource(InputCloud& cloud, std::string name, const std::string& left_out);
  /// Selects the rows `chosen`, which ascend, of another source. Borrows both.
  RowSource(RowSource& rows, std::span<const std::uint64_t> chosen);

  const Schema& schema() const { return schema_; }
  std::uint64_t count() const { return count_; }
  const std::string& name() const { return name_; }  ///< name of the first file, or of all files together
  /// Returns the files of the rows, ascending by their first rows.
  std::span<const FileOfRows> files() const { return files_; }
  /// Returns the number of rows that make a piece of about 4 MB.
  std::size_t block_rows() const { return std::max<std::size_t>(1, kBlockBytes / schema_.stride); }

  /// Returns the records [first, first + count), all of which exist; valid until the next call. Throws Error if the
  /// file has changed.
  std::span<const std::byte> read(std::uint64_t first, std::size_t count);

 private:
  static constexpr std::size_t kBlockBytes = 4 << 20;

  Schema schema_;
  std::uint64_t count_;
  std::string name_;
  std::vector<FileOfRows> files_;
  std::function<std::size_t(std::uint64_t, std::span<std::byte>)> read_;
  std::vector<std::byte> block_;
};

/// Calls `use(row, position)` for every point, finite or not, in the order of rows.
void for_each_position(RowSource& source, const char* phase, const PhaseProgress& progress,
                       const std::function<void(std::uint64_t row, Vec3 position)>& use);

/// Calls `use(i, record)` with the record of rows[i], for each i. `rows` ascend. Skips blocks without any of `rows`.
void for_each_record(RowSource& source, std::span<const std::uint64_t> rows,
                     const std::function<void(std::size_t i, const std::byte* record)>& use);

}  // namespace pointsweep
