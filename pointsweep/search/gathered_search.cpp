// SPDX-License-Identifier: MIT
#include "pointsweep/search/cell_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/search/gathered_search.cpp"
#include "pointsweep/math/instruction_sets.h"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/contrib/sort/vqsort.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "pointsweep/cancellation.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/math/front_lanes-inl.h"
#include "pointsweep/search/bin_search-inl.h"
#include "pointsweep/search/near_leaves-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {

/// Finds the neighbours of the points of one cell. The reach of a point is the distance at which its neighbourhood
/// ends. The search for the neighbours of a point p begins with a bound from the point q that was searched before p:
/// the reach of p is at most the reach of q plus |p - q|.
class GatheredSearch {
 public:
  GatheredSearch(const CellQuery& query, std::uint64_t most, SearchScratch& scratch, CellNeighbors& out)
      : query_(query), cell_(query.cell()), what_(query.what), scratch_(scratch), out_(out), most_(most) {}

  /// Searches `points` one after another until the lists hold `most_` neighbours in total. Returns the number of
  /// searched points.
  std::uint32_t run(const CellSubset& points) {
    scratch_.near.find(query_, 0);
    if (!unlimited()) settle_first(points[0]);
    std::uint32_t n = 0;
    while (n < points.size() && (n == 0 || out_.refs.size() < most_)) {
      const std::uint32_t i = points[n], leaf = i / kLeafCapacity;
      const std::uint32_t end_of_same = std::min(end_of_copies(cell_, leaf) * kLeafCapacity, cell_.size());
      if (end_of_same > leaf * kLeafCapacity) {
        n += search_same(i, end_of_run(points.from(n), end_of_same)) - i;
        continue;
      }
      const bool gathered = gather(leaf);
      const std::uint32_t end = leaf * kLeafCapacity + cell_.leaf_size(leaf);
      for (bool first = true; n < points.size() && points[n] < end && (first || out_.refs.size() < most_); ++n) {
        search_one(points[n], gathered);
        first = false;
      }
    }
    return n;
  }

 private:
  /// Returns the end of the run of successive indices with which `points` begins, at most `end`.
  static std::uint32_t end_of_run(const CellSubset& points, std::uint32_t end) {
    std::uint32_t n = 1;
    while (n < points.size() && points[n] < end && points[n] == points[0] + n) ++n;
    return points[0] + n;
  }

  static constexpr std::uint64_t kDistanceBits = ~std::uint64_t{0} << 32;
  static constexpr std::size_t kMostCopied = 4096;  ///< largest number of candidates that are copied for sorting
  static constexpr NeighborRef kNoPoint = ~NeighborRef{0};  ///< reference to no point: no cell has the last slot

  bool unlimited() const { return what_.k == Neighborhood::kUnlimited; }

  void search_one(std::uint32_t i, bool gathered) {
    stop_if_cancelled();
    if (gathered) {
      search_point(i);
    } else if (unlimited()) {
      append_all(cell_.position(i), make_ref(query_.slot, i));
      finish_point(i, what_.radius2());
    } else {
      settle_plainly(i);
    }
  }

  /// Searches points [i, end), which are in leaves whose points all coincide. Coincident points share their neighbours,
  /// and are neighbours of each other. Returns the index after the last searched point.
  std::uint32_t search_same(std::uint32_t i, std::uint32_t end) {
    if (!unlimited()) {
      const std::uint64_t points = std::max<std::uint64_t>((most_ - out_.refs.size()) / what_.k, 1);
      const auto behind = static_cast<std::uint32_t>(std::min<std::uint64_t>(end, i + points));
      search_copies(query_, i, behind, scratch_, out_);
      settled(i, out_.reach2.back());
      return behind;
    }
    find_leaves({cell_.position(i), cell_.position(i)}, what_.radius2(), std::numeric_limits<std::size_t>::max());
    const std::span<const std::uint64_t> keys = all_within(cell_.position(i), kNoPoint);
    for (const std::uint32_t begin = i; i < end && (i == begin || out_.refs.size() < most_); ++i) {
      stop_if_cancelled();
      make_room(keys.size());
      const NeighborRef self = make_ref(query_.slot, i);
      for (const std::uint64_t key : keys)
        if (static_cast<NeighborRef>(key) != self) out_.refs.push_back(static_cast<NeighborRef>(key));
      finish_point(i, what_.radius2());
    }
    return i;
  }

  /// Searches point `i` in double precision without vector lanes, only to learn the reach of the point: from this
  /// reach, reach2_after() bounds the reaches of the points of the first leaf.
  void settle_first(std::uint32_t i) {
    search_point_plainly(query_, i, scratch_);
    const std::vector<Candidate>& found = scratch_.best.finish();
    settled(i, found.size() == what_.k ? found.back().distance2 : what_.radius2());
  }

  void settle_plainly(std::uint32_t i) {
    search_point_plainly(query_, i, scratch_);
    append_best(what_, scratch_, out_);
    settled(i, out_.reach2.back());
  }

  /// Returns a bound of the squared reach of every point whose distance from the point searched last is at most `step`.
  /// The factor covers rounding, and the summand covers squares that underflow.
  double reach2_after(double step) const {
    const double reach = settled_reach_ + step;
    return std::min(what_.radius2(), reach * reach * (1 + 1e-9) + 1e-300);
  }

  /// Copies all points that may be neighbours of the points of a leaf to scratch_.gathered, the points of the nearest
  /// leaf first. Returns false if the points would come from more than kMostGathered / 16 leaves.
  bool gather(std::uint32_t leaf) {
    const Box around = box_of(leaf);
    const Vec3 a = around.lo - settled_at_, b = around.hi - settled_at_;
    const double reach2 = reach2_after(length({farther(a.x, b.x), farther(a.y, b.y), farther(a.z, b.z)}));
    constexpr std::size_t kMost = kMostGathered / kLeafCapacity;
    find_leaves(around, reach2, unlimited() ? std::numeric_limits<std::size_t>::max() : kMost);
    if (scratch_.leaves.size() > kMost) return false;
    by_bins_ = true;
    copy_leaves(leaf);
    return true;
  }

  /// Finds the leaves within sqrt(reach2) of a box in the cell, nearest first. If there are more than `most`, the
  /// result is incomplete and in no order.
  void find_leaves(const Box& around, double reach2, std::size_t most) {
    // Without a limit k, no later reach exceeds the radius. With a limit k, a look-up within twice the reach saves
    // later look-ups.
    if (!(reach2 <= scratch_.near.reach2)) scratch_.near.find(query_, unlimited() ? reach2 : 4 * reach2);
    const auto all = [](std::uint32_t, std::uint32_t) { return true; };
    collect_near_leaves(query_.directory, scratch_.near.cells, around, reach2, most, all, scratch_.leaves);
  }

  /// Reads the found leaves and returns the keys of all their points within the radius of p, except `self`, nearest
  /// first. The lower 32 bits of a key are the NeighborRef.
  std::span<const std::uint64_t> all_within(Vec3 p, NeighborRef self) {
    const hn::CappedTag<double, kLeafCapacity> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    std::vector<std::uint64_t>& keys = scratch_.gathered.key;
    const std::size_t room = scratch_.leaves.size() * kLeafCapacity + kLeafCapacity;
    if (keys.size() < room) {
      free_memory_of(keys);
      keys.resize(room + room / 8);
    }
    const auto px = hn::Set(d, p.x), py = hn::Set(d, p.y), pz = hn::Set(d, p.z), limit = hn::Set(d, what_.radius2());
    const auto distance_bits = hn::Set(du, kDistanceBits), own = hn::Set(du, self);
    std::size_t count = 0;
    for (const std::uint64_t leaf_key : scratch_.leaves) {
      const std::uint32_t slot = scratch_.near.cells[NearLeaf::place(leaf_key)].slot, l = NearLeaf::leaf(leaf_key);
      const Cell& cell = query_.directory.cell(slot);
      const std::uint32_t from = l * kLeafCapacity, size = cell.leaf_size(l);
      for (std::uint32_t i = 0; i < size; i += static_cast<std::uint32_t>(hn::Lanes(d))) {
        const auto dx = hn::Sub(hn::LoadU(d, cell.x + from + i), px);
        const auto dy = hn::Sub(hn::LoadU(d, cell.y + from + i), py);
        const auto dz = hn::Sub(hn::LoadU(d, cell.z + from + i), pz);
        const auto d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
        const auto name = hn::Iota(du, make_ref(slot, from + i));
        const auto within = hn::And(hn::Le(d2, limit), hn::FirstN(d, size - i));
        const auto keep = hn::AndNot(hn::Eq(name, own), hn::RebindMask(du, within));
        hn::StoreU(Front<decltype(du)>(keep)(hn::OrAnd(name, hn::BitCast(du, d2), distance_bits)), du, &keys[count]);
        count += hn::CountTrue(du, keep);
      }
    }
    sort_(keys.data(), count, hwy::SortAscending());
    settle_ties(p, count, count);
    return {keys.data(), count};
  }

  void append_all(Vec3 p, NeighborRef self) {
    const std::span<const std::uint64_t> keys = all_within(p, self);
    make_room(keys.size());
    for (const std::uint64_t key : keys) out_.refs.push_back(static_cast<NeighborRef>(key));
  }

  /// Reserves room in out_.refs for `more` entries: twice the needed capacity, but at most `most_` unless more is
  /// needed.
  void make_room(std::size_t more) {
    const std::size_t needed = out_.refs.size() + more;
    if (needed <= out_.refs.capacity()) return;
    out_.refs.reserve(std::max<std::size_t>(needed, std::min<std::uint64_t>(2 * needed, most_)));
  }

  static double farther(double a, double b) { return std::max(std::abs(a), std::abs(b)); }

  Box box_of(std::uint32_t leaf) const {
    Box box;
    for (std::uint32_t i = 0; i < cell_.leaf_size(leaf); ++i) box.include(cell_.position(leaf * kLeafCapacity + i));
    return box;
  }

  void copy_leaves(std::uint32_t leaf) {
    GatheredPoints& to = scratch_.gathered;
    to.reserve(scratch_.leaves.size() * kLeafCapacity + kLeafCapacity, BinSort::kPadding);
    to.end.clear();
    std::uint32_t n = 0;
    for (const std::uint64_t key : scratch_.leaves) {
      const std::uint32_t slot = scratch_.near.cells[NearLeaf::place(key)].slot, l = NearLeaf::leaf(key);
      const Cell& cell = query_.directory.cell(slot);
      const std::uint32_t from = l * kLeafCapacity, size = cell.leaf_size(l);
      if (slot == query_.slot && l == leaf) own_begin_ = n;
      for (std::uint32_t i = 0; i < kLeafCapacity; ++i) {  // copies a whole leaf; the next leaf overwrites its padding
        to.x[n + i] = cell.x[from + i], to.y[n + i] = cell.y[from + i], to.z[n + i] = cell.z[from + i];
        to.ref[n + i] = make_ref(slot, from + i);
      }
      to.end.push_back(n += size);
    }
  }

  void search_point(std::uint32_t i) {
    const Vec3 p = cell_.position(i);
    const double limit2 = reach2_after(length(p - settled_at_));
    const std::size_t candidates = points_within(limit2);
    by_bins_ = by_bins_ && BinSearch::can_bin(limit2);
    std::size_t count = by_bins_ ? append_by_bins(i, p, limit2, candidates) : 0;
    if (!by_bins_) count = append_by_distances(i, p, limit2, candidates);
    finish_point(i, count >= what_.k ? distance2(position(out_.refs.back()), p) : what_.radius2());
  }

  /// Appends the list of a point whose candidates are the first `candidates` gathered points. Returns how many of the
  /// candidates are within sqrt(limit2).
  std::size_t append_by_distances(std::uint32_t i, Vec3 p, double limit2, std::size_t candidates) {
    const std::size_t count = keep_within(limit2, p, make_ref(query_.slot, i), candidates);
    std::uint64_t* keys = scratch_.gathered.key.data();
    sort_(keys, count, hwy::SortAscending());
    const std::size_t size = std::min(count, what_.k);
    settle_ties(p, count, size);
    make_room(size);
    for (std::size_t j = 0; j < size; ++j) out_.refs.push_back(static_cast<NeighborRef>(keys[j]));
    return count;
  }

  /// Appends the list like append_by_distances(). If too many points share a bin, appends nothing and clears by_bins_.
  std::size_t append_by_bins(std::uint32_t i, Vec3 p, double limit2, std::size_t candidates) {
    BinSearch bins(scratch_.gathered, candidates, limit2);
    const std::size_t count = bins.find(p, own_begin_ + i % kLeafCapacity, what_.k);
    const std::size_t sorted = bins.sorted(), before = out_.refs.size();
    by_bins_ = bins.sharing() <= 4 + sorted / 16;
    if (!by_bins_) return 0;
    make_room(sorted);
    out_.refs.resize(before + sorted);
    bins.write(out_.refs.data() + before, [&](std::span<NeighborRef> refs) { order_refs(p, refs); });
    out_.refs.resize(before + std::min(sorted, what_.k));
    return count;
  }

  void order_refs(Vec3 p, std::span<NeighborRef> refs) {
    std::vector<Candidate>& run = scratch_.gathered.run;
    run.clear();
    for (const NeighborRef ref : refs) run.push_back(candidate_from(query_.directory, ref, p));
    std::sort(run.begin(), run.end(), nearer);
    for (std::size_t j = 0; j < refs.size(); ++j) refs[j] = run[j].ref;
  }

  /// Returns the number of gathered points in leaves within sqrt(limit2) of the searched leaf.
  std::size_t points_within(double limit2) const {
    const auto& leaves = scratch_.leaves;
    const auto beyond = std::upper_bound(leaves.begin(), leaves.end(), NearLeaf::key(not_near(limit2), 0xFFFFFF, 0xFF));
    return beyond == leaves.begin() ? 0 : scratch_.gathered.end[static_cast<std::size_t>(beyond - leaves.begin()) - 1];
  }

  /// Writes the keys of the candidates within sqrt(limit2) of p, except `self`. A key holds the upper half of the bits
  /// of the squared distance, and below them the NeighborRef. Returns the number of keys.
  std::size_t keep_within(double limit2, Vec3 p, NeighborRef self, std::size_t size) {
    const hn::ScalableTag<double> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    const hn::Rebind<std::uint32_t, decltype(d)> d32;
    const std::size_t lanes = hn::Lanes(d);
    GatheredPoints& from = scratch_.gathered;
    const auto px = hn::Set(d, p.x), py = hn::Set(d, p.y), pz = hn::Set(d, p.z), limit = hn::Set(d, limit2);
    const auto own = hn::Set(du, self), distance_bits = hn::Set(du, kDistanceBits);
    std::size_t count = 0;
    for (std::size_t i = 0; i < size; i += lanes) {
      const auto dx = hn::Sub(hn::LoadU(d, &from.x[i]), px), dy = hn::Sub(hn::LoadU(d, &from.y[i]), py);
      const auto dz = hn::Sub(hn::LoadU(d, &from.z[i]), pz);
      const auto d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
      const auto name = hn::PromoteTo(du, hn::LoadU(d32, &from.ref[i]));
      const auto within = hn::And(hn::Le(d2, limit), hn::FirstN(d, size - i));
      const auto keep = hn::AndNot(hn::Eq(name, own), hn::RebindMask(du, within));
      const auto key = hn::OrAnd(name, hn::BitCast(du, d2), distance_bits);
      hn::StoreU(Front<decltype(du)>(keep)(key), du, &from.key[count]);  // count <= i: a whole vector has room
      count += hn::CountTrue(du, keep);
    }
    return count;
  }

  /// Puts candidates whose keys have the same bits of the distance into exact order, unless these candidates are beyond
  /// the end of the list, which has `size` entries.
  void settle_ties(Vec3 p, std::size_t count, std::size_t size) {
    std::uint64_t* keys = scratch_.gathered.key.data();
    for (std::size_t begin = 0; begin + 1 < count && begin < size; ++begin) {
      if (((keys[begin] ^ keys[begin + 1]) & kDistanceBits) != 0) continue;
      std::size_t end = begin + 2;
      while (end < count && ((keys[begin] ^ keys[end]) & kDistanceBits) == 0) ++end;
      order_run(p, keys + begin, end - begin, std::min(end, size) - begin);
      begin = end - 1;
    }
  }

  void order_run(Vec3 p, std::uint64_t* keys, std::size_t size, std::size_t wanted) {
    if (size > kMostCopied) return order_long_run(p, keys, size, wanted);
    std::vector<Candidate>& run = scratch_.gathered.run;
    run.clear();
    for (std::size_t i = 0; i < size; ++i)
      run.push_back(candidate_from(query_.directory, static_cast<NeighborRef>(keys[i]), p));
    std::partial_sort(run.begin(), run.begin() + static_cast<std::ptrdiff_t>(wanted), run.end(), nearer);
    for (std::size_t i = 0; i < wanted; ++i) keys[i] = run[i].ref;
  }

  /// Sorts a long run in place, so that many points at one distance, as in a grid or among copies of a point, take no
  /// additional memory.
  void order_long_run(Vec3 p, std::uint64_t* keys, std::size_t size, std::size_t wanted) const {
    const auto candidate = [&](std::uint64_t key) {
      return candidate_from(query_.directory, static_cast<NeighborRef>(key), p);
    };
    std::partial_sort(keys, keys + wanted, keys + size,
                      [&](std::uint64_t a, std::uint64_t b) { return nearer(candidate(a), candidate(b)); });
  }

  Vec3 position(NeighborRef ref) const { return query_.directory.cell(slot_of(ref)).position(index_of(ref)); }

  void finish_point(std::uint32_t i, double reach2) {
    out_.reach2.push_back(reach2);
    out_.begin.push_back(static_cast<std::uint32_t>(out_.refs.size()));
    settled(i, reach2);
  }

  void settled(std::uint32_t i, double reach2) {
    settled_at_ = cell_.position(i);
    settled_reach_ = std::sqrt(reach2);
  }

  const CellQuery query_;
  const Cell& cell_;
  const Neighborhood& what_;
  SearchScratch& scratch_;
  CellNeighbors& out_;
  const hwy::Sorter sort_;
  const std::uint64_t most_;
  std::uint32_t own_begin_ = 0;  ///< number, among the gathered points, of the first point of the searched leaf
  bool by_bins_ = true;          ///< false once sorting by bins has failed for a point of the leaf
  Vec3 settled_at_;              ///< position of the point searched last
  double settled_reach_ = std::numeric_limits<double>::infinity();  ///< reach of the point searched last
};

std::uint32_t search_in_gathered(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                                 SearchScratch& scratch, CellNeighbors& out) {
  return GatheredSearch(query, most, scratch, out).run(points);
}

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();
#else
namespace pointsweep {
namespace HWY_NAMESPACE {
std::uint32_t search_in_gathered(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                                 SearchScratch& scratch, CellNeighbors& out) {
  return search_plainly(query, points, most, scratch, out);
}
}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
#endif

#if HWY_ONCE
namespace pointsweep {
HWY_EXPORT(search_in_gathered);

std::uint32_t search_gathered(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                              SearchScratch& scratch, CellNeighbors& out) {
  return HWY_DYNAMIC_DISPATCH(search_in_gathered)(query, points, most, scratch, out);
}

}  // namespace pointsweep
#endif
