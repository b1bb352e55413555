// SPDX-License-Identifier: MIT
/// The neighbourhood operator Φ_X for all points of a cell at once (paper Section 4.2.2), exact over the cells of a
/// directory.
///
/// Deviation from the paper: instead of a kD-heap that is updated point by point, all points of a leaf walk the leaves
/// of the window together, one query per vector lane, and keep their k nearest in registers. Single precision only
/// filters: if it cannot decide between two candidates, the point is searched in double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/search/best_list.h"
#include "pointsweep/search/cell.h"

namespace pointsweep {

/// Neighbour lists of the points of one cell, in the order of its points.
struct CellNeighbors {
  std::vector<std::uint32_t> begin;  ///< size() + 1 entries; list i is refs[begin[i] .. begin[i+1]), nearest first
  std::vector<NeighborRef> refs;
  /// For each point: an upper bound of the squared radius of the ball in which every point must be known for the list
  /// to be exact. The ball extends to the kth neighbour or has the radius of the query; the bound is infinite if fewer
  /// than k points were found and no radius limits the search.
  std::vector<double> reach2;

  std::uint32_t size() const { return static_cast<std::uint32_t>(begin.size() - 1); }
  /// Returns the bytes of memory that the lists take.
  std::uint64_t list_bytes() const { return refs.size() * sizeof(NeighborRef) + begin.size() * sizeof(std::uint32_t); }
};

/// Points copied to one place with their references, and buffers for a search among them.
struct GatheredPoints {
  std::vector<double> x, y, z;
  std::vector<NeighborRef> ref;
  std::vector<std::uint32_t> end;  ///< for each gathered leaf, the number of gathered points up to its end
  std::vector<std::uint64_t> key;  ///< for each point found, bits of its squared distance, then its NeighborRef
  std::vector<std::uint32_t> bin_key, spare_key;  ///< keys and scratch of BinSort
  std::vector<Candidate> run;                     ///< points at about one distance, while they are compared exactly

  void reserve(std::size_t size, std::size_t padding) {
    if (size <= ref.size()) return;
    for (auto* c : {&x, &y, &z}) grow(*c, size);
    grow(ref, size), grow(key, size);
    grow(bin_key, size + padding), grow(spare_key, 2 * size + padding);
  }

 private:
  /// Reserves before resizing, because resize() alone may allocate up to twice as much.
  template <class T>
  static void grow(std::vector<T>& values, std::size_t size) {
    values.reserve(size);
    values.resize(size);
  }
};

/// A search for at most kMostInLanes neighbours handles the points of a leaf in vector lanes. A search for more
/// neighbours, or for all points within a radius, gathers the points around a leaf, at most kMostGathered of them.
inline constexpr std::size_t kMostInLanes = 64;
inline constexpr std::size_t kMostGathered = 1 << 15;
/// Bytes of memory for each gathered point in GatheredPoints, including the unused places of leaves that are not full.
inline constexpr std::uint64_t kGatheredPointBytes = 64;

/// A query for the neighbours of all points of one cell: the cell, the directory that holds it, and the neighbourhood.
struct CellQuery {
  const CellDirectory& directory;
  std::uint32_t slot;
  const Neighborhood& what;

  const Cell& cell() const { return directory.cell(slot); }
};

/// The cells near the cell of a query, nearest first.
struct NearCells {
  std::vector<CellDirectory::Near> cells;
  double reach2 = 0;  ///< `cells` holds every cell within this squared distance of the box of the query's cell

  void find(const CellQuery& query, double within2) {
    reach2 = within2;
    query.directory.find(query.cell().box, within2, cells);
  }
};

/// Memory reused from cell to cell by one thread.
struct SearchScratch {
  NearCells near;
  std::vector<std::uint64_t> leaves;  ///< leaves near the current query, as keys of NearLeaf (near_leaves-inl.h)
  GatheredPoints gathered;
  BestList best;
  std::uint64_t settled_in_double = 0;  ///< points that single precision could not decide
};

/// Finds the neighbourhoods of the first of `points`, until `most` neighbours are found or all points are searched.
/// Returns the number of searched points; `out` holds exactly the lists of these points, each complete. Thread-safe
/// with one scratch per thread.
///
/// If k is at most 64, all points are searched; a leaf of which `points` has any point is searched at the cost of all
/// 16 points. Memory in addition to `out`: with a limit k, at most 128 bytes × k, and the gathered points;
/// without, 14 bytes for each point in the leaves within the radius of one point.
std::uint32_t search(const CellQuery& query, const CellSubset& points, std::uint64_t most, SearchScratch& scratch,
                     CellNeighbors& out);

/// A value of `most` that exceeds the size of all lists.
inline constexpr std::uint64_t kAllLists = ~std::uint64_t{0};

/// The function search() for any k > 0 and any radius, for many neighbours: the points around a leaf are gathered once,
/// then every point of the leaf scans them, a candidate per vector lane, all in double precision. Appends to `out`. If
/// more than 2,048 leaves lie around a leaf, their points are not gathered: each point of the leaf scans these leaves,
/// or, with a limit k, is searched by search_point_plainly(). 15 to 30 ns per neighbour on one core with AVX-512, about
/// half of it for sorting.
std::uint32_t search_gathered(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                              SearchScratch& scratch, CellNeighbors& out);

// The neighbourhood operator point by point in double precision, for any k and radius. The functions below serve points
// that the vector code cannot decide, many copies of one point, and machines without vectors.

/// Searches the neighbourhood of the point with index `i` and leaves it in scratch.best, on which the caller calls
/// finish(). scratch.near holds cells near the cell of the query, and grows as needed.
void search_point_plainly(const CellQuery& query, std::uint32_t i, SearchScratch& scratch);

/// Searches the neighbourhood of a place in the cell, without the point with row `self_row`, and leaves the
/// neighbourhood in scratch.best.
void search_place_plainly(const CellQuery& query, Vec3 place, std::uint64_t self_row, SearchScratch& scratch);

/// Appends the neighbourhood in scratch.best to `out`, and the squared distance at which it ends.
void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out);

/// The function search() for any k; appends to `out`.
std::uint32_t search_plainly(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                             SearchScratch& scratch, CellNeighbors& out);

/// Returns a point of a cell as a candidate for the neighbourhood of p.
inline Candidate candidate_from(const CellDirectory& directory, NeighborRef ref, Vec3 p) {
  const Cell& cell = directory.cell(slot_of(ref));
  const Vec3 at = cell.position(index_of(ref));
  return {distance2(at, p), at, cell.row[index_of(ref)], ref};
}

/// Sorts runs of a list of at most 64 neighbours of p exactly, where single precision could not decide. Bit i of
/// `close_to_next` says that places i and i + 1 belong to one run.
void order_runs(const CellDirectory& directory, Vec3 p, std::uint64_t close_to_next, NeighborRef* refs);

/// Returns the end of the run of leaves, from `leaf` on, whose points all coincide; returns `leaf` if its points differ
/// or if it has only one.
std::uint32_t end_of_copies(const Cell& cell, std::uint32_t leaf);

/// Appends the neighbourhoods of points [first, end), which coincide, to `out`. One search is enough: coincident points
/// share their k + 1 nearest points, and each point leaves out itself. scratch.near is used as in
/// search_point_plainly().
void search_copies(const CellQuery& query, std::uint32_t first, std::uint32_t end, SearchScratch& scratch,
                   CellNeighbors& out);

}  // namespace pointsweep
