// SPDX-License-Identifier: MIT
/// Components of a graph without weights whose edges join the points of a tile with each other and with points of other
/// tiles: each tile finds its own components, which are then joined by the edges that cross from tile to tile
/// (docs/adr/0021).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/connect/edge_batch.h"
#include "pointsweep/connect/edge_buckets.h"
#include "pointsweep/connect/forest_log.h"
#include "pointsweep/connect/vote_rule.h"
#include "pointsweep/part/tile_reader.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/points/sorted_records.h"
#include "pointsweep/storage/local/spill_file.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// The rows of a tile in its cloud.
struct RowsOfTile {
  std::uint64_t first = 0, count = 0;

  bool has(std::uint64_t row) const { return row - first < count; }
};

/// An edge from a row of the tile to a row of another one.
struct Crossing {
  std::uint64_t from, to;

  friend auto operator<=>(const Crossing&, const Crossing&) = default;
};
using SortedCrossings = SortedRecords<Crossing, std::less<>>;

/// Takes the edges that points of a tile emit: those among them go to buckets, the others cross.
class TileEdges final : public EdgeSink {
 public:
  /// `take_crossings`: gets the edges of a batch that cross; its calls follow each other.
  TileEdges(EdgeBuckets& own, RowsOfTile rows, std::function<void(std::span<const ForestEdge>)> take_crossings)
      : own_(own), rows_(rows), take_crossings_(std::move(take_crossings)) {}
  bool weighted() const override { return own_.weighted(); }
  void put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) override;

 private:
  EdgeBuckets& own_;
  RowsOfTile rows_;
  std::mutex mutex_;
  std::function<void(std::span<const ForestEdge>)> take_crossings_;
};

struct TileGraphSetup {
  const VoteRule* votes = nullptr;  ///< may be null
  MakeScratch make_scratch;
  SpillPlace spill = nullptr;  ///< for what is put in the order of rows
  std::uint64_t memory_bytes = 0;
  std::function<void(std::uint64_t points)> progress;
};

/// Finds the components of a tile and leaves three lists under `name`: NAME.labels, by row the number of its component,
/// none for points without a place; NAME.components, in the order of their numbers, which is that of their first
/// points; NAME.crossings.
void leave_graph(const EdgeBuckets& own, SortedCrossings& crossings, RowsOfTile rows, const TileGraphSetup& setup,
                 Storage& scratch, const std::string& name);

/// Leaves the lists of a tile without rows. `votes`: TileGraphSetup::votes.
void leave_no_graph(const VoteRule* votes, Storage& scratch, const std::string& name);

/// Joins the components of all tiles by their crossings, and numbers them by their first points. Leaves the list
/// KEY.numbers, and for each tile where in it the components of the tile are; KEY is there when all is. Memory: about
/// 150 bytes and the votes of each component that a crossing touches.
void join_graphs(Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                 const TileGraphSetup& setup, const std::string& key);

/// Calls use(row in the tile, label) for each point of a tile that has a place, in no order.
void for_each_label(const Storage& scratch, const std::string& name, const std::string& key, std::size_t tile,
                    const TileGraphSetup& setup,
                    const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use);

}  // namespace pointsweep
