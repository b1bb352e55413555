// SPDX-License-Identifier: MIT
/// A source of rows, read in blocks and in sequence from a cloud or a single file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/geometry.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// A function called between pieces of work with the work done and the total work. An exception from this function ends
/// the work.
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
  /// `name`: name of all files together in messages. `left_out`: a field that the source hides; empty for none.
  RowSource(InputCloud& cloud, std::string name, const std::string& left_out);
  /// Selects the rows `chosen`, which ascend, of another source. Borrows both.
  RowSource(RowSource& rows, std::span<const std::uint64_t> chosen);

  /// Returns the rows of `rows` with NaN for all coordinates of points that are not finite.
  static RowSource without_nonfinite(const RowSource& rows);

  const Schema& schema() const { return schema_; }
  std::uint64_t count() const { return count_; }
  const std::string& name() const { return name_; }  ///< name of the first file, or of all files together
  /// Returns the files of the rows, ascending by their first rows.
  std::span<const FileOfRows> files() const { return files_; }
  /// Returns the number of rows that make a piece of about 4 MB.
  std::size_t block_rows() const { return std::max<std::size_t>(1, kBlockBytes / schema_.stride); }

  /// Returns the records [first, first + count), all of which exist; valid until the next call. Throws Error if the
  /// file ends earlier, because it has changed.
  std::span<const std::byte> read(std::uint64_t first, std::size_t count);
  /// Returns block_rows() records from row `first` on, or fewer at the end of the rows; none if `first` is count().
  std::span<const std::byte> read_block(std::uint64_t first);

 private:
  static constexpr std::size_t kBlockBytes = 4 << 20;

  Schema schema_;
  std::uint64_t count_;
  std::string name_;
  std::vector<FileOfRows> files_;
  std::function<std::size_t(std::uint64_t, std::span<std::byte>)> read_;
  std::vector<std::byte> block_;
};

/// Calls `use(first, records, n)` for successive blocks of rows: `n` records from row `first` on. Calls `progress`,
/// unless empty, with `phase` after each block.
template <class Use>
void for_each_block(RowSource& source, const char* phase, const PhaseProgress& progress, Use use) {
  for (std::uint64_t first = 0; first < source.count();) {
    stop_if_cancelled();
    const std::span<const std::byte> records = source.read_block(first);
    const std::size_t n = records.size() / source.schema().stride;
    use(first, records.data(), n);
    first += n;
    if (progress) progress(phase, first, source.count());
  }
}

/// Calls `use(row, record)` for every row, in order. Reports progress like for_each_block().
template <class Use>
void for_each_row(RowSource& source, const char* phase, const PhaseProgress& progress, Use use) {
  for_each_block(source, phase, progress, [&](std::uint64_t first, const std::byte* records, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) use(first + i, records + i * source.schema().stride);
  });
}

/// Returns the position that a record holds.
inline Vec3 position_in(const PositionFields& fields, const std::byte* record) {
  return {value_of(fields.x, record), value_of(fields.y, record), value_of(fields.z, record)};
}

/// A key by which rows are in canonical order along an axis.
using SweepKey = std::tuple<bool, double, double, double, double, std::uint64_t>;

/// Returns the key of a row: rows are ordered by the coordinate on the axis, ties by x, y, z, then row; points that are
/// not finite come last, by row.
inline SweepKey sweep_key(Vec3 p, std::uint64_t row, int axis) {
  return is_finite(p) ? SweepKey{false, p[axis], p.x, p.y, p.z, row} : SweepKey{true, 0, 0, 0, 0, row};
}

/// Calls `use(row, position)` for every point, finite or not, in the order of rows.
void for_each_position(RowSource& source, const char* phase, const PhaseProgress& progress,
                       const std::function<void(std::uint64_t row, Vec3 position)>& use);

/// Calls `use(i, record)` with the record of rows[i], for each i. `rows` ascend. Skips blocks without any of `rows`.
void for_each_record(RowSource& source, std::span<const std::uint64_t> rows,
                     const std::function<void(std::size_t i, const std::byte* record)>& use);

}  // namespace pointsweep
