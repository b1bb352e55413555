// SPDX-License-Identifier: MIT
/// The levels of detail of a cloud: the leaves of its octree, the depth at which each point is first drawn, and any
/// number of records with their levels, in bounded memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/levels/curve_points.h"
#include "pointsweep/levels/curve_records.h"
#include "pointsweep/levels/disc_choice.h"
#include "pointsweep/levels/level_grid.h"
#include "pointsweep/points/scratch.h"
#include "pointsweep/points/sorted_records.h"

namespace pointsweep {

/// An octant with more points than this is divided, unless all its points lie in one cell (level_grid.h).
inline constexpr std::uint64_t kMostLeafPoints = 100'000;

/// An octant that is not divided, and the numbers of its points on the curve.
struct Leaf {
  CurveKey key;  ///< first key of the octant
  int depth;
  std::uint64_t first, count;
  std::uint64_t end() const { return first + count; }
};

/// Returns the leaf that contains the octant. Returns null if no leaf contains the octant, because the octant is
/// divided or lies in a child without points of a divided octant. `leaves`: all leaves in order.
const Leaf* leaf_around(std::span<const Leaf> leaves, const Octant& octant);

/// Finds the leaves of the octree in one pass along the Morton curve.
class LeafFinder {
 public:
  LeafFinder() { first_.fill(0); }
  /// Takes the keys of the next points. Keys must not descend.
  void add(std::span<const CurveKey> keys);
  /// Returns the leaves in the order of the curve; empty if there are no points.
  std::vector<Leaf> finish();

 private:
  void close(int depth);

  std::array<std::uint64_t, kMostDepth + 1> first_;  ///< for each depth, number of the first point in the octant of
                                                     ///< the last point
  CurveKey last_;
  std::uint64_t count_ = 0;
  std::uint64_t first_at_last_ = 0;  ///< number of the first point with the key of the last point
  std::vector<Leaf> leaves_;
};

/// The root of the octree keeps at most this many points, unless all points lie in one cell.
inline constexpr std::size_t kMostRootPoints = 100'000;

/// The width of the cube divided by the spacing of the root, unless the root would keep too many points.
inline constexpr double kDiscsAcrossCube = 128;

/// Chooses the points of depth 0, then of depth 1, and so on. At depth d all points of the leaves of that depth are
/// taken. Then each node, an octant that is divided, keeps points, in the order of choose_discs(), that are at least
/// the spacing s_d from all points taken before. Nodes whose numbers along x, y and z are even come first, then the
/// other seven parities. Nodes of one parity are farther apart than s_d, so the threads take them in any order.
///
/// s_0 is the width of the cube / kDiscsAcrossCube * sqrt(2)^i with the least i = 0, 1, ... for which the root keeps at
/// most kMostRootPoints points, and s_d = s_0 / 2^d.
class LevelChoice {
 public:
  /// `memory_bytes`: memory for sorting the rows of the points that nodes keep; no limit if `room` has no files.
  /// `leaves`: leaves of all `points`.
  LevelChoice(const CurvePoints& points, std::vector<Leaf> leaves, ScratchRoom& room, std::uint64_t memory_bytes);

  /// Chooses the levels. Must be called once, before the functions below.
  void run();
  double spacing() const { return spacing_; }  ///< s_0, in units of the grid
  /// Returns the depth of the next point along the curve.
  int next_depth();

 private:
  struct Node {
    CurveKey key;
    NodeRows rows;
    bool is_done = false;
    PointLists::List list = {};  ///< points in the node, or up to 1 unit outside, taken at this and lower depths
  };
  struct Depth {
    int depth;
    double spacing;
    std::vector<Node> nodes;  ///< divided nodes, in order
    PointLists lists;
  };
  struct Kept {
    std::vector<KeptPoint> chosen;
    std::vector<GridPoint> all;  ///< points of the future Node::list
  };

  std::vector<Node> divided_nodes(int depth) const;
  void choose_root(Depth& root);
  void choose_nodes(Depth& now, const Depth& before);
  std::optional<Kept> choose_node(const Depth& now, const Depth* before, const Node& node, std::size_t most) const;
  std::vector<GridPoint> excluders(const Depth& now, const Depth* before, const Octant& octant, const Box& near) const;
  void end_node(Depth& now, Node& node, const Kept& kept);
  void list_borders(int depth, double spacing);
  std::vector<GridPoint> border_of(const Leaf& leaf, double spacing) const;
  static const Node* find_node(const std::vector<Node>& nodes, const Octant& octant);

  const CurvePoints& points_;
  const LevelGrid& grid_;
  std::vector<Leaf> leaves_;
  ScratchRoom& room_;
  double spacing_;
  std::uint64_t taken_ = 0;                         ///< points in the lists of the last depth
  PointLists borders_;                              ///< points of leaves near enough to their faces to exclude points
                                                    ///< outside of the leaf
  std::vector<PointLists::List> border_;            ///< list of each leaf in borders_
  SortedRecords<std::uint64_t, std::less<>> kept_;  ///< row * 32 + depth of each kept point
  std::optional<std::uint64_t> next_kept_;
  std::uint64_t next_row_ = 0;
  std::size_t next_leaf_ = 0;
};

/// Returns the least memory in bytes that LevelledRecords needs for `threads` threads.
std::uint64_t least_level_bytes(unsigned threads);

/// Returns whether LevelledRecords with `memory_bytes` of memory writes `bytes` bytes of records to a scratch.
bool puts_records_aside(std::uint64_t bytes, std::uint64_t memory_bytes);

/// Records that begin with a GridPoint, sorted along the Morton curve, with the depth at which each is first drawn.
class LevelledRecords {
 public:
  /// `memory_bytes`: limit for the memory of this object. Without `files`, all records stay in memory, even beyond the
  /// limit.
  LevelledRecords(std::size_t record_bytes, std::uint64_t memory_bytes, const MakeScratch& files);

  void add(std::span<const std::byte> records) { records_.add(records); }

  /// Chooses the levels. Must be called once, after the last add() and before the functions below. `scale`: the length
  /// of a step on each axis, in units of the cloud.
  void choose(Vec3 scale);
  const LevelGrid& grid() const { return *grid_; }
  /// Returns the spacing of the points of depth 0, in units of the cloud, like `scale`.
  double spacing() const { return spacing_ * grid_->unit(); }

  using Use = std::function<void(const CurveKey& key, int depth, const std::byte* record)>;
  /// Calls `use` with all records in Morton order. Must be called only once.
  void for_each(const Use& use);
  /// Returns the memory and files that are left for scratches of the caller.
  ScratchRoom& room() { return room_; }

 private:
  std::size_t record_bytes_;
  std::uint64_t memory_;
  CurveRecords records_;
  ScratchRoom room_;
  std::optional<LevelGrid> grid_;
  std::optional<CurvePoints> points_;
  std::optional<LevelChoice> choice_;
  double spacing_ = 0;
};

}  // namespace pointsweep
