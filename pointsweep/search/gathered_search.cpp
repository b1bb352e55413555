// SPDX-License-Identifier: MIT
#include "pointsweep/search/gathered_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/search/gathered_search.cpp"
#include "pointsweep/math/instruction_sets.h"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/contrib/sort/vqsort.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "pointsweep/math/front_lanes-inl.h"
#include "pointsweep/search/copies.h"
#include "pointsweep/search/exact_order.h"
#include "pointsweep/search/near_leaves-inl.h"
#include "pointsweep/search/plain_search.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {

/// The search of one cell. How far a neighbourhood reaches is known beforehand from the point settled last: that of a
/// point p ends within the reach of any point q plus |p - q|.
class GatheredSearch {
 public:
  GatheredSearch(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what, SearchScratch& scratch,
                 CellNeighbors& out)
      : directory_(directory), cell_(directory.cell(slot)), slot_(slot), what_(what), scratch_(scratch), out_(out) {}

  void run() {
    directory_.find(cell_.box, known2_, scratch_.near);
    if (what_.k != Neighborhood::kUnlimited) settle_first();
    for (std::uint32_t leaf = 0; leaf < cell_.leaf_count(); ++leaf) {
      const std::uint32_t first = leaf * kLeafCapacity, size = cell_.leaf_size(leaf);
      if (const std::uint32_t end = end_of_copies(cell_, leaf); end > leaf) {
        search_copies(directory_, cell_, first, std::min(end * kLeafCapacity, cell_.size()), what_, scratch_, known2_,
                      out_);
        settled(first, out_.reach2.back());
        leaf = end - 1;
      } else if (gather(leaf)) {
        for (std::uint32_t i = first; i < first + size; ++i) search_point(i);
      } else {
        for (std::uint32_t i = first; i < first + size; ++i) settle_plainly(i);
      }
    }
  }

 private:
  /// More points than this around one leaf are not gathered.
  static constexpr std::size_t kMostGathered = 1 << 15;
  static constexpr std::uint64_t kDistanceBits = ~std::uint64_t{0} << 32;

  /// The reach of the first point, from which all others follow.
  void settle_first() {
    search_point_plainly(directory_, cell_, 0, what_, scratch_, known2_);
    const std::vector<Candidate>& found = scratch_.best.finish();
    settled(0, found.size() == what_.k ? found.back().distance2 : what_.radius2());
  }

  void settle_plainly(std::uint32_t i) {
    search_point_plainly(directory_, cell_, i, what_, scratch_, known2_);
    append_best(what_, scratch_, out_);
    settled(i, out_.reach2.back());
  }

  /// Squared distance within which every neighbourhood ends of points at most `step` from the point settled last. The
  /// factor covers rounding, the summand squares that underflow.
  double reach2_after(double step) const {
    const double reach = settled_reach_ + step;
    return std::min(what_.radius2(), reach * reach * (1 + 1e-9) + 1e-300);
  }

  /// Copies together all points that those of a leaf may need, leaf after leaf by distance. False if they are too many.
  bool gather(std::uint32_t leaf) {
    const Box around = box_of(leaf);
    const Vec3 a = around.lo - settled_at_, b = around.hi - settled_at_;
    const double reach2 = reach2_after(length({farther(a.x, b.x), farther(a.y, b.y), farther(a.z, b.z)}));
    if (!(reach2 <= known2_)) {
      known2_ = 4 * reach2;
      directory_.find(cell_.box, known2_, scratch_.near);
    }
    constexpr std::size_t kMost = kMostGathered / kLeafCapacity;
    const auto all = [](std::uint32_t, std::uint32_t) { return true; };
    collect_near_leaves(directory_, scratch_.near, around, reach2, kMost, all, scratch_.leaves);
    if (scratch_.leaves.size() > kMost) return false;
    copy_leaves();
    return true;
  }

  static double farther(double a, double b) { return std::max(std::abs(a), std::abs(b)); }

  Box box_of(std::uint32_t leaf) const {
    Box box;
    for (std::uint32_t i = 0; i < cell_.leaf_size(leaf); ++i) box.include(cell_.position(leaf * kLeafCapacity + i));
    return box;
  }

  void copy_leaves() {
    GatheredPoints& to = scratch_.gathered;
    to.reserve(scratch_.leaves.size() * kLeafCapacity + kLeafCapacity);
    to.end.clear();
    std::uint32_t n = 0;
    for (const std::uint64_t key : scratch_.leaves) {
      const std::uint32_t slot = scratch_.near[NearLeaf::place(key)].slot, l = NearLeaf::leaf(key);
      const Cell& cell = directory_.cell(slot);
      const std::uint32_t from = l * kLeafCapacity, size = cell.leaf_size(l);
      for (std::uint32_t i = 0; i < kLeafCapacity; ++i) {  // whole leaves; what is behind their end is overwritten
        to.x[n + i] = cell.x[from + i], to.y[n + i] = cell.y[from + i], to.z[n + i] = cell.z[from + i];
        to.ref[n + i] = make_ref(slot, from + i);
      }
      to.end.push_back(n += size);
    }
  }

  void search_point(std::uint32_t i) {
    const Vec3 p = cell_.position(i);
    const double limit2 = reach2_after(length(p - settled_at_));
    const std::size_t count = keep_within(limit2, p, make_ref(slot_, i), points_within(limit2));
    std::uint64_t* keys = scratch_.gathered.key.data();
    sort_(keys, count, hwy::SortAscending());
    const std::size_t size = std::min(count, what_.k);
    settle_ties(p, count, size);
    for (std::size_t j = 0; j < size; ++j) out_.refs.push_back(static_cast<NeighborRef>(keys[j]));
    finish_point(i, count >= what_.k ? distance2(position(out_.refs.back()), p) : what_.radius2());
  }

  /// How many of the gathered points belong to leaves within sqrt(limit2) of the leaf searched.
  std::size_t points_within(double limit2) const {
    const auto& leaves = scratch_.leaves;
    const auto beyond = std::upper_bound(leaves.begin(), leaves.end(), NearLeaf::key(not_near(limit2), 0xFFFFFF, 0xFF));
    return beyond == leaves.begin() ? 0 : scratch_.gathered.end[static_cast<std::size_t>(beyond - leaves.begin()) - 1];
  }

  /// Writes the keys of the candidates within sqrt(limit2) of p, all but itself: the upper half of their squared
  /// distance, below it their name.
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

  /// Candidates whose distances begin with the same bits are put into exact order, as far as they get into the list.
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
    std::vector<Candidate>& run = scratch_.gathered.run;
    run.clear();
    for (std::size_t i = 0; i < size; ++i)
      run.push_back(candidate_from(directory_, static_cast<NeighborRef>(keys[i]), p));
    std::partial_sort(run.begin(), run.begin() + static_cast<std::ptrdiff_t>(wanted), run.end(), nearer);
    for (std::size_t i = 0; i < wanted; ++i) keys[i] = run[i].ref;
  }

  Vec3 position(NeighborRef ref) const { return directory_.cell(slot_of(ref)).position(index_of(ref)); }

  void finish_point(std::uint32_t i, double reach2) {
    out_.reach2.push_back(reach2);
    out_.begin.push_back(static_cast<std::uint32_t>(out_.refs.size()));
    settled(i, reach2);
  }

  void settled(std::uint32_t i, double reach2) {
    settled_at_ = cell_.position(i);
    settled_reach_ = std::sqrt(reach2);
  }

  const CellDirectory& directory_;
  const Cell& cell_;
  const std::uint32_t slot_;
  const Neighborhood& what_;
  SearchScratch& scratch_;
  CellNeighbors& out_;
  const hwy::Sorter sort_;
  double known2_ = 0;  ///< scratch_.near holds every cell within it of the cell's box
  Vec3 settled_at_;
  double settled_reach_ = std::numeric_limits<double>::infinity();
};

void search_gathered(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what,
                     SearchScratch& scratch, CellNeighbors& out) {
  GatheredSearch(directory, slot, what, scratch, out).run();
}

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();
#else
namespace pointsweep {
namespace HWY_NAMESPACE {
void search_gathered(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what,
                     SearchScratch& scratch, CellNeighbors& out) {
  search_cell_plainly(directory, slot, what, scratch, out);
}
}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
#endif

#if HWY_ONCE
namespace pointsweep {
HWY_EXPORT(search_gathered);

void search_cell_gathered(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what,
                          SearchScratch& scratch, CellNeighbors& out) {
  HWY_DYNAMIC_DISPATCH(search_gathered)(directory, slot, what, scratch, out);
}

}  // namespace pointsweep
#endif
