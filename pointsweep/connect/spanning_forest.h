// SPDX-License-Identifier: MIT
/// The minimum spanning forest of a graph that comes in pieces. Only points whose edges are not all known are in
/// memory.
///
/// A point is open as long as more edges of the point may come. A supernode is a set of points that edges of the final
/// forest join; at least one of its points is open. Candidates are edges between supernodes: the minimum spanning
/// forest of the edges that have come so far. An edge that is the largest of a cycle is not in the final forest (cycle
/// property), so that new edges are compared with the candidates alone. All edges of a supernode without open points
/// are known. The least of its candidates belongs to the final forest (cut property), so that the supernode is merged
/// with the other end of that candidate; a supernode without candidates is a whole component. The log gets a record of
/// each merge and each component. With weights, the result is that of Kruskal's algorithm on the whole graph, however
/// the edges are divided and whenever points are closed (docs/adr/0014).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/forest_log.h"
#include "pointsweep/connect/row_table.h"

namespace pointsweep {

/// The state of a forest with open points, as a value: its supernodes and the candidates between them. Another forest
/// can adopt it.
struct OpenForest {
  struct Point {
    std::uint64_t row;
    std::uint32_t supernode;  ///< index of the supernode that holds the point
    bool flips;               ///< true if the sign of the point differs from the sign of its supernode
  };
  struct Candidate {
    ForestEdge edge;
    std::uint32_t a, b;  ///< indices of the two supernodes
    bool flips;          ///< true if the supernodes should have opposite signs
  };
  std::vector<FinishedComponent> supernodes;  ///< first point and number of points of each supernode, so far
  std::vector<std::byte> votes;               ///< votes of the supernodes, one after another
  std::vector<Point> points;                  ///< open points and the supernodes that hold them
  std::vector<Candidate> candidates;          ///< candidates, ascending by edge
};

class SpanningForest {
 public:
  /// If not `weighted`, all weights are equal and no edge flips, so that any spanning forest gives the components;
  /// edges then need rows only, no positions. `votes` is null if components need no votes. `votes` and `log` must
  /// outlive this object.
  SpanningForest(bool weighted, const VoteRule* votes, ForestLog& log);

  /// Opens points; `ballots` holds the ballots of the points one after another. Appends the rows of new points to
  /// `opened`. A point that is already open is ignored.
  void open(std::span<const PointKey> points, std::span<const std::byte> ballots, std::vector<std::uint64_t>& opened);
  /// Adds edges between open points.
  void join(std::span<const ForestEdge> edges);
  /// Closes open points. No later edge may name a closed point.
  void close(std::span<const std::uint64_t> rows);
  /// Ends this forest and returns its open part. The log ends with the supernodes of that part in order, as if they
  /// were components, with results of zeros.
  OpenForest leave();
  /// Adds the open part of another forest; none of its points may be open in this forest. The log names the added
  /// supernodes as points with the rows `first`, `first` + 1 and so on.
  void adopt(const OpenForest& left, std::uint64_t first);

  std::size_t open_points() const { return open_.size(); }
  std::size_t supernodes() const { return live_.size(); }
  std::size_t candidates() const { return candidates_.size(); }
  /// Returns the largest number of supernodes in memory at once; a merged supernode stays in memory until close().
  std::size_t slots() const { return supernodes_.size(); }

 private:
  struct OpenPoint {
    std::uint32_t slot = 0;
    bool flips = false;  ///< true if the sign of the point differs from the sign of its supernode
  };
  struct Supernode {
    std::uint64_t row = 0;     ///< row of the point for which the supernode was made
    FinishedComponent sums;    ///< first point and number of points of the supernode
    std::uint64_t open = 0;    ///< number of open points of the supernode
    std::uint32_t parent = 0;  ///< own slot; after a merge, the slot of the supernode that took this one
    bool flips = false;        ///< true if the sign of the supernode differs from the sign of its parent
  };
  using Candidate = OpenForest::Candidate;  ///< a candidate whose `a` and `b` are slots
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
  RowTable<OpenPoint> open_;                  ///< open points by row
  std::deque<Supernode> supernodes_;          ///< supernode in each slot
  std::deque<std::vector<std::byte>> votes_;  ///< votes of each slot, in pages of kPageSlots: growth copies no votes
  std::vector<std::uint32_t> live_, free_;
  std::vector<Candidate> candidates_;  ///< candidates, ascending by edge
  std::vector<std::uint32_t> joined_;  ///< for each slot, its parent among the supernodes that candidates join
};

}  // namespace pointsweep
