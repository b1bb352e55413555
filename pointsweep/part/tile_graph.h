// SPDX-License-Identifier: MIT
/// Components of a graph without weights whose edges join the points of a tile with each other and with points of other
/// tiles: each tile finds its own components, which are then joined by the edges that cross from tile to tile
/// (docs/adr/0021). In names of objects, NAME stands for the argument `name` or the name of a tile in `names`, KEY for
/// the argument `key`, and TILE for the number of a tile.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/connect/edge_batch.h"
#include "pointsweep/connect/forest_log.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/points/sorted_records.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/local/spill_file.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// The range of the cloud's rows that belong to a tile.
struct RowsOfTile {
  std::uint64_t first = 0, count = 0;

  bool has(std::uint64_t row) const { return row - first < count; }
};

/// An edge from a row of one tile to a row of another tile.
struct Crossing {
  std::uint64_t from, to;

  friend auto operator<=>(const Crossing&, const Crossing&) = default;
};
using SortedCrossings = SortedRecords<Crossing, std::less<>>;

/// Takes the edges that points of a tile emit. Edges between two points of the tile go to buckets (edge_buckets.h);
/// edges to other tiles (crossings) go to a function.
class TileEdges final : public EdgeSink {
 public:
  /// `take_crossings` gets the edges of a batch that lead to other tiles; its calls do not overlap.
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
  const VoteRule* votes = nullptr;  ///< rule by which points of a component vote; null if there are no votes
  MakeScratch make_scratch;
  SpillPlace spill = nullptr;      ///< place for labels that do not fit in memory; null: all labels stay in memory
  std::uint64_t memory_bytes = 0;  ///< bytes of memory for sorting and for labels
  std::function<void(std::uint64_t points)> progress;
};

/// Finds the components of a tile and seals three lists: NAME.labels, the number of the component of each row, kNoLabel
/// for non-finite points; NAME.components, the components in the order of their first points, which gives their
/// numbers; NAME.crossings, one Crossing for each row of another tile and each component of this tile that edges join:
/// `from` is the row, `to` the number of the component.
void leave_graph(const EdgeBuckets& own, SortedCrossings& crossings, RowsOfTile rows, const TileGraphSetup& setup,
                 Storage& scratch, const std::string& name);

/// Seals the three lists of leave_graph() without records, for a tile without rows. `votes`: TileGraphSetup::votes.
void leave_no_graph(const VoteRule* votes, Storage& scratch, const std::string& name);

/// Joins the components of all tiles by their crossings, and numbers them by their first points. Seals an object
/// KEY-TILE for each tile, which lists the segments of KEY.numbers with the components of the tile, then the list
/// KEY.numbers, then the object KEY. Memory: about 150 bytes and the votes for each component that a crossing touches.
void join_graphs(Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                 const TileGraphSetup& setup, const std::string& key);

/// Calls use(row in the tile, label) for each point of a tile with finite coordinates, in an unspecified order.
void for_each_label(const Storage& scratch, const std::string& name, const std::string& key, std::size_t tile,
                    const TileGraphSetup& setup,
                    const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use);

/// The label of a row without a component.
inline constexpr std::uint64_t kNoLabel = ~std::uint64_t{0};
inline constexpr Encoding kSegmentsEncoding{"joined components of a tile", 1};

/// Returns a store with kNoLabel for each row of a tile.
inline RowStore store_of_labels(std::uint64_t rows, const TileGraphSetup& setup) {
  const std::vector<std::byte> none(sizeof kNoLabel, std::byte{0xff});
  return {rows, none, setup.spill, std::max<std::uint64_t>(setup.memory_bytes / 4, 1 << 20)};
}

/// A vote rule whose result is the sum of the votes by another rule, so that components of several tiles can be joined
/// before their votes are concluded. If the other rule is null, there are no votes. turns() is not forwarded, because
/// edges without weights flip no signs.
class OpenVotes final : public VoteRule {
 public:
  explicit OpenVotes(const VoteRule* rule) : rule_(rule) {}
  std::size_t ballot_bytes() const override { return rule_ != nullptr ? rule_->ballot_bytes() : 0; }
  std::size_t bytes() const override { return rule_ != nullptr ? rule_->bytes() : 0; }
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override {
    if (rule_ != nullptr) rule_->start(votes, point, ballot);
  }
  void merge(std::byte* into, const std::byte* from, bool flips) const override {
    if (rule_ != nullptr) rule_->merge(into, from, flips);
  }
  std::size_t result_bytes() const override { return bytes(); }
  void conclude(const std::byte* votes, std::byte* result) const override { std::copy_n(votes, bytes(), result); }

  /// Returns the size in bytes of the result that conclude_to() makes; 0 without a rule.
  std::size_t concluded_bytes() const { return rule_ != nullptr ? rule_->result_bytes() : 0; }
  /// Concludes votes into `result`, and returns whether the component gets a number.
  bool conclude_to(const std::byte* votes, std::byte* result) const {
    if (rule_ == nullptr) return true;
    rule_->conclude(votes, result);
    return rule_->counts(result);
  }

 private:
  const VoteRule* rule_;
};

/// Bytes of the record of a tile's component: a FinishedComponent. The votes of the component follow and are not
/// counted.
inline constexpr std::size_t kComponentBytes = sizeof(PointKey) + sizeof(std::uint64_t);

inline FinishedComponent component_at(const std::byte* record) {
  FinishedComponent component;
  std::memcpy(&component.first, record, sizeof component.first);
  std::memcpy(&component.points, record + sizeof component.first, sizeof component.points);
  return component;
}

/// Bytes of the record of a component of the whole cloud: its number and its count of points. The result of its votes
/// follows and is not counted.
inline constexpr std::size_t kNumberedBytes = 2 * sizeof(std::uint64_t);

inline void put_number(std::byte* record, std::uint64_t number, std::uint64_t points) {
  std::memcpy(record, &number, sizeof number);
  std::memcpy(record + sizeof number, &points, sizeof points);
}

/// Successive records of the list KEY.numbers (join_graphs()) that belong to components of one tile.
struct Segment {
  std::uint64_t first, count;
};

}  // namespace pointsweep
