// SPDX-License-Identifier: MIT
/// The minimum spanning forest of a graph that comes in pieces, in memory for the points whose edges are not all known.
///
/// A point is open as long as edges of it may come. A supernode is a set of points that edges of the final forest join;
/// at least one of them is open. Between supernodes there are candidates, the edges of the minimum spanning forest of
/// what has come. An edge that is the largest of a cycle is not in the final forest (cycle property), so that new edges
/// are compared with the candidates alone. All edges of a supernode without open points are known: the least of its
/// candidates belongs to the final forest (cut property), and the supernode becomes part of the other end; without
/// candidates it is a component. Each such step is a record of the log. The result is that of Kruskal's algorithm on
/// the whole graph, for every division of the edges and every time at which points are closed (docs/adr/0014).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/forest_log.h"
#include "pointsweep/connect/row_table.h"
#include "pointsweep/connect/vote_rule.h"

namespace pointsweep {

/// A forest with open points as a value: its supernodes and the candidates between them. Another forest can adopt it.
struct OpenForest {
  struct Point {
    std::uint64_t row;
    std::uint32_t supernode;
    bool flips;  ///< the sign of the point differs from the sign of its supernode
  };
  struct Candidate {
    ForestEdge edge;
    std::uint32_t a, b;  ///< supernodes
    bool flips;          ///< the edge asks for opposite signs of the supernodes
  };
  std::vector<FinishedComponent> supernodes;  ///< so far
  std::vector<std::byte> votes;               ///< of the supernodes, one after another
  std::vector<Point> points;                  ///< those that are open
  std::vector<Candidate> candidates;          ///< ascending
};

class SpanningForest {
 public:
  /// Not `weighted`: all weights are equal and no edge flips, so that any forest tells the components; edges need not
  /// name positions then. `votes` may be null. `votes` and `log` must outlive this object.
  SpanningForest(bool weighted, const VoteRule* votes, ForestLog& log);

  /// Opens points; `ballots` holds their ballots one after another. Appends the rows of new points to `opened`; a point
  /// that is open already is ignored.
  void open(std::span<const PointKey> points, std::span<const std::byte> ballots, std::vector<std::uint64_t>& opened);
  /// Adds edges between open points.
  void join(std::span<const ForestEdge> edges);
  /// Closes open points: no edge that names one of these points comes later.
  void close(std::span<const std::uint64_t> rows);
  /// Ends this forest. The log ends with its open supernodes, in their order, as if they were components; the results
  /// of their votes tell nothing.
  OpenForest leave();
  /// Goes on with what another forest has left, whose points are not open here. The log knows its supernodes as points
  /// of the rows `first`, `first` + 1 and so on.
  void adopt(const OpenForest& left, std::uint64_t first);

  std::size_t open_points() const { return open_.size(); }
  std::size_t supernodes() const { return live_.size(); }
  std::size_t candidates() const { return candidates_.size(); }
  /// Returns the largest number of supernodes that existed at once.
  std::size_t slots() const { return supernodes_.size(); }

 private:
  struct OpenPoint {
    std::uint32_t slot = 0;
    bool flips = false;  ///< the sign of the point differs from the sign of its supernode
  };
  struct Supernode {
    std::uint64_t row = 0;  ///< row of the point for which the supernode was made
    FinishedComponent sums;
    std::uint64_t open = 0;
    std::uint32_t parent = 0;  ///< its own slot; after a merge, the slot of another supernode
    bool flips = false;        ///< the sign of the supernode differs from the sign of its parent
  };
  using Candidate = OpenForest::Candidate;  ///< between slots
  struct Root {
    std::uint32_t slot;
    bool flips;
  };

  std::uint32_t new_slot();
  Root root_of(std::uint32_t slot);
  void merge(Root a, Root b, bool flips);
  std::byte* votes_of(std::uint32_t slot) { return votes_[slot / kPageSlots].data() + slot % kPageSlots * vote_bytes_; }
  std::span<const std::byte> votes_of(std::uint32_t slot) const {
    return {votes_[slot / kPageSlots].data() + slot % kPageSlots * vote_bytes_, vote_bytes_};
  }
  void take_candidates(std::size_t before);
  void contract();
  void let_go();

  static constexpr std::size_t kPageSlots = 256;

  bool weighted_;
  const VoteRule* rule_;
  std::size_t vote_bytes_;
  std::vector<std::byte> result_;  ///< result of the votes of a component
  ForestLog& log_;
  RowTable<OpenPoint> open_;                  ///< by row
  std::deque<Supernode> supernodes_;          ///< by slot
  std::deque<std::vector<std::byte>> votes_;  ///< votes by slot, in pages: they grow without a copy
  std::vector<std::uint32_t> live_, free_;
  std::vector<Candidate> candidates_;  ///< ascending
  std::vector<std::uint32_t> joined_;  ///< by slot: a set of supernodes that candidates join
};

}  // namespace pointsweep
