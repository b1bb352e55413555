// SPDX-License-Identifier: MIT
/// The neighbourhood operator Φ_X (Pajarola 2005, Section 4.2.2) for all points of a cell at once, exact over the cells
/// of a directory. Cells, leaves, slots and the directory: cell.h.
///
/// Deviation from the paper, which updates a kD-heap point by point: the search compares all points of a leaf with the
/// leaves around it together, one query point per vector lane, and keeps the k nearest of each query in registers.
/// Single precision only filters: if it cannot decide between two candidates, the search compares their distances in
/// double precision.
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
  /// Returns the bytes of `refs` and `begin` together.
  std::uint64_t list_bytes() const { return refs.size() * sizeof(NeighborRef) + begin.size() * sizeof(std::uint32_t); }
};

/// Copies of the points of several leaves in contiguous arrays, and buffers for a search among these points.
struct GatheredPoints {
  std::vector<double> x, y, z;
  std::vector<NeighborRef> ref;
  std::vector<std::uint32_t> end;  ///< for each gathered leaf, the number of gathered points up to its end
  std::vector<std::uint64_t> key;  ///< for each point found, 32 bits of its squared distance above its NeighborRef
  std::vector<std::uint32_t> bin_key, spare_key;  ///< keys and scratch of BinSort (sort_lanes-inl.h)
  std::vector<Candidate> run;                     ///< points with almost equal distances, for the exact comparison

  /// Makes room for `size` points, and for `padding` keys that BinSort may access beyond the keys of the points.
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
/// neighbours, or for all points within a radius, copies the points around a leaf to GatheredPoints, at most
/// kMostGathered of them.
inline constexpr std::size_t kMostInLanes = 64;
inline constexpr std::size_t kMostGathered = 1 << 15;
/// Bytes of memory for each gathered point in GatheredPoints, including the unused places of leaves that are not full.
inline constexpr std::uint64_t kGatheredPointBytes = 64;

/// A query for the neighbours of all points of one cell: the slot of the cell, the directory that contains the cell,
/// and the definition of the neighbourhood.
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

/// Buffers that one thread reuses from cell to cell.
struct SearchScratch {
  NearCells near;
  std::vector<std::uint64_t> leaves;  ///< leaves near the current query, as keys of NearLeaf (near_leaves-inl.h)
  GatheredPoints gathered;
  BestList best;
  std::uint64_t settled_in_double = 0;  ///< number of points that single precision could not decide
};

/// Finds the neighbourhoods of `points` one after another. Stops when all points are searched, or after the point with
/// which the lists reach `most` neighbours in total. Returns the number of searched points; `out` then holds exactly
/// the lists of these points, each complete. Thread-safe with one scratch per thread.
///
/// If 0 < k <= 64, `most` is ignored, and the search of one point of a leaf costs as much as that of all 16 points.
/// Memory in addition to `out`: with a limit k, room for 2k + 32 candidates of 48 bytes. If k > 64 or unlimited, also
/// the gathered points. If k is unlimited, also up to 170 bytes for each leaf within the radius of the searched leaf.
std::uint32_t search(const CellQuery& query, const CellSubset& points, std::uint64_t most, SearchScratch& scratch,
                     CellNeighbors& out);

/// A value of `most` that exceeds the size of all lists.
inline constexpr std::uint64_t kAllLists = ~std::uint64_t{0};

/// Does the work of search() for many neighbours, with any k > 0 and any radius; appends to `out`. The function gathers
/// the points around a leaf once, then compares every point of the leaf with all gathered points in double precision,
/// one candidate per vector lane. If the points would come from more than 2,048 leaves, nothing is gathered: the search
/// of each point reads the leaves themselves or, with a limit k, is search_point_plainly(). Cost: 15 to 30 ns per
/// neighbour on one core with AVX-512, about half of it for sorting.
std::uint32_t search_gathered(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                              SearchScratch& scratch, CellNeighbors& out);

// The functions below search point by point in double precision, for any k and radius, or are parts of such a search.
// The vector code calls them for points that it cannot decide and for many copies of one point. Machines without vector
// instructions use them for all points.

/// Searches the neighbourhood of the point with index `i` and leaves it in scratch.best, on which the caller calls
/// finish(). The caller has set scratch.near by find() for the same query; this function extends scratch.near as
/// needed.
void search_point_plainly(const CellQuery& query, std::uint32_t i, SearchScratch& scratch);

/// Does the work of search_point_plainly() for a place in the box of the cell, and excludes the point with row
/// `self_row`.
void search_place_plainly(const CellQuery& query, Vec3 place, std::uint64_t self_row, SearchScratch& scratch);

/// Appends the neighbourhood in scratch.best to `out`, with the squared distance at which the neighbourhood ends.
void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out);

/// Does the work of search() for any k, even 0; appends to `out`.
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
/// or if it has only one point.
std::uint32_t end_of_copies(const Cell& cell, std::uint32_t leaf);

/// Appends the neighbourhoods of points [first, end), which coincide, to `out`. One search is enough: coincident points
/// share their k + 1 nearest points, and each point leaves out itself. Uses scratch.near as search_point_plainly()
/// does.
void search_copies(const CellQuery& query, std::uint32_t first, std::uint32_t end, SearchScratch& scratch,
                   CellNeighbors& out);

}  // namespace pointsweep
