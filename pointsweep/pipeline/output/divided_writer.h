// SPDX-License-Identifier: MIT
/// An output that is divided among many files: tiles, or a file for each value of an attribute.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "pointsweep/formats/format.h"
#include "pointsweep/pipeline/output/grouped_records.h"
#include "pointsweep/pipeline/output/output_warnings.h"
#include "pointsweep/pipeline/output/tile_grid.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/run.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Largest number of files of a run that may not overwrite files.
inline constexpr std::size_t kMostFiles = 10'000;

/// Memory and scratch for the records that wait for their files.
struct DivisionRoom {
  std::uint64_t bytes = 0;   ///< memory, without the memory of the files' encoders
  MakeScratch scratch = {};  ///< for records that do not fit in memory
  /// Gets the number of points that are written or about to be written. May be empty, and may throw.
  std::function<void(std::uint64_t points)> progress = {};
};

/// The least DivisionRoom::bytes.
inline constexpr std::uint64_t kLeastDivisionBytes = 16 << 20;

/// Stores records as they come (GroupedRecords). After the last record it writes the files, several small ones in
/// parallel. Each file has the layout of the whole output (one grid, one header except for counts and bounds) and its
/// points in their order. A file is complete or absent.
///
/// The tile of a point is decided by the coordinates that a reader of the output gets, after any rounding of its
/// format. Points without a finite x and y have a file of their own, `unplaced`.
class DividedWriter final : public Writer {
 public:
  /// `plan.path` is the path of the files, with a * for the name of each. Throws the errors of create_writer(), and
  /// UsageError for an attribute whose values cannot divide points.
  DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room);

  void write(std::span<const std::byte> records) override;
  void finish() override;
  std::size_t files() const { return complete_; }  ///< number of complete files

 private:
  /// The identity of a file: the two numbers of a tile, or the value of the attribute and 0.
  struct Key {
    std::int64_t first = 0, second = 0;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  struct File {
    Key key;
    std::uint64_t own = 0, all = 0;  ///< points, without and with the points in its buffer
  };
  /// A small file whose records wait to be written in parallel with others.
  struct Waiting {
    std::uint32_t file;
    std::vector<std::byte> records;
  };

  void choose_attribute(const std::string& word);
  void find_keys(std::span<const std::byte> records);
  Key key_of(const std::byte* record) const;
  void put(Key key, const std::byte* record, bool is_own);
  void put_into_buffers(const std::byte* record, const Key& own);
  std::string name_of(const Key& key) const;
  std::filesystem::path path_of(std::uint32_t file) const;
  OutputPlan plan_of(std::uint32_t file) const;
  void require_possible() const;
  void write_files();
  void report(std::uint64_t records) const;
  void write_together(std::vector<Waiting>& waiting);
  void complete_large(Writer& writer, std::uint32_t file);

  OutputPlan plan_;
  OutputDivision division_;
  DivisionRoom room_;
  std::size_t record_bytes_;  ///< of incoming records
  std::optional<TileGrid> grid_;
  std::array<Field, 2> xy_;     ///< x and y in the records, for tiles
  StoredCoordinate stored_;     ///< coordinate after the rounding of the output's format
  Field attribute_;             ///< field of the records whose values divide them
  std::string attribute_name_;  ///< as part of file names
  std::optional<GroupedRecords> records_;
  std::vector<Key> keys_;  ///< of the latest records
  std::vector<File> files_;
  std::unordered_map<Key, std::uint32_t, KeyHash> file_of_;
  std::uint64_t came_ = 0, put_ = 0;  ///< incoming records; records and their copies in buffers
  std::size_t with_points_ = 0;       ///< files with points outside of their buffer
  std::atomic<std::size_t> complete_ = 0;
  OutputWarnings file_warnings_;
};

}  // namespace pointsweep
