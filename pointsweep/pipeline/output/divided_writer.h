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

/// The most files that a run makes unless it may overwrite files.
inline constexpr std::size_t kMostFiles = 10'000;

/// The room in which records wait for their files.
struct DivisionRoom {
  std::uint64_t bytes = 0;   ///< memory, without what the encoders of the files take
  MakeScratch scratch = {};  ///< for what does not fit
  /// Gets the number of points whose files are written, or about to be; may be empty, and may throw.
  std::function<void(std::uint64_t points)> progress = {};
};

/// The least DivisionRoom::bytes.
inline constexpr std::uint64_t kLeastDivisionBytes = 16 << 20;

/// Puts records aside by file as they come (GroupedRecords), and writes the files one after another, small ones side by
/// side, when all have come. Each file has the layout of the whole output (one grid, one header but for counts and
/// bounds) and its points in their order, and is complete or absent.
///
/// A tile is decided by the coordinates that a reader of the output gets, after any rounding of its format. Points
/// without a finite x and y are in a file of their own, `unplaced`.
class DividedWriter final : public Writer {
 public:
  /// `plan.path` is the path of the files with a * for the name of each. Throws what create_writer() throws, and
  /// UsageError for an attribute by whose values points cannot be divided.
  DividedWriter(OutputPlan plan, const OutputDivision& division, DivisionRoom room);

  void write(std::span<const std::byte> records) override;
  void finish() override;
  std::size_t files() const { return complete_; }  ///< that are complete

 private:
  /// Two numbers that stand for a file: those of a tile, or the value of the attribute and 0.
  struct Key {
    std::int64_t first = 0, second = 0;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  struct File {
    Key key;
    std::uint64_t own = 0, all = 0;  ///< points, without and with those of its buffer
  };
  /// A small file whose records wait to be written beside others.
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
  std::size_t record_bytes_;  ///< of records that come
  std::optional<TileGrid> grid_;
  std::array<Field, 2> xy_;     ///< of the records, for tiles
  StoredCoordinate stored_;     ///< of the output's format
  Field attribute_;             ///< of the records, for a division by values
  std::string attribute_name_;  ///< in names of files
  std::optional<GroupedRecords> records_;
  std::vector<Key> keys_;  ///< of the records that came last
  std::vector<File> files_;
  std::unordered_map<Key, std::uint32_t, KeyHash> file_of_;
  std::uint64_t came_ = 0, put_ = 0;  ///< records that came; those and their copies in buffers
  std::size_t with_points_ = 0;  ///< files that have points of their own
  std::atomic<std::size_t> complete_ = 0;
  OutputWarnings file_warnings_;
};

}  // namespace pointsweep
