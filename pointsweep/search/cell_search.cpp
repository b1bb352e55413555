// SPDX-License-Identifier: MIT
#include "pointsweep/search/cell_search.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pointsweep/search/cell_search.cpp"
#include "pointsweep/math/instruction_sets.h"
// clang-format off
#include <hwy/foreach_target.h>
// clang-format on
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/exp.h"
#include "pointsweep/search/leaf_query-inl.h"
#include "pointsweep/search/near_leaves-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace pointsweep {
namespace HWY_NAMESPACE {

/// The search of one cell, leaf by leaf, with lists of K >= k neighbours. The queries (the points of a leaf) form
/// groups, one query per vector lane. All groups share the list of near leaves, and the coordinates of their points in
/// single precision.
template <std::size_t K>
class CellSearch {
 public:
  CellSearch(const CellQuery& query, SearchScratch& scratch, CellNeighbors& out)
      : query_(query), cell_(query.cell()), what_(query.what), scratch_(scratch), out_(out) {}

  /// Searches `points` leaf by leaf. Successive leaves whose points all coincide are searched together.
  void run(const CellSubset& points) {
    scratch_.near.find(query_, 0);
    for (std::uint32_t n = 0, end = 0; n < points.size(); n = end) {
      stop_if_cancelled();
      const std::uint32_t leaf = points[n] / kLeafCapacity, end_of_same = end_of_copies(cell_, leaf);
      end = points.count_below(std::max(leaf + 1, end_of_same) * kLeafCapacity);
      const CellSubset here = points.part(n, end - n);
      end_of_same > leaf ? search_some_copies(here) : search_some(leaf, here);
    }
  }

 private:
  void search_some_copies(const CellSubset& points) {
    for (std::uint32_t n = 0, end = 0; n < points.size(); n = end) {
      for (end = n + 1; end < points.size() && points[end] == points[end - 1] + 1;) ++end;
      search_copies(query_, points[n], points[end - 1] + 1, scratch_, out_);
    }
  }

  /// Searches the leaf and keeps only the lists of `points`.
  void search_some(std::uint32_t leaf, const CellSubset& points) {
    const std::size_t before = out_.reach2.size();
    const bool all = points.size() == cell_.leaf_size(leaf);
    wanted_ = all ? ~0u : 0;
    for (std::uint32_t n = 0; !all && n < points.size(); ++n) wanted_ |= 1u << points[n] % kLeafCapacity;
    search_leaf(leaf);
    if (all) return;
    std::size_t kept = before;
    std::uint32_t end = out_.begin[before];
    for (std::uint32_t n = 0; n < points.size(); ++n) {
      const std::size_t from = before + points[n] % kLeafCapacity;
      const std::uint32_t begin = out_.begin[from], behind = out_.begin[from + 1];
      std::copy(out_.refs.begin() + begin, out_.refs.begin() + behind, out_.refs.begin() + end);
      out_.reach2[kept] = out_.reach2[from];
      end += behind - begin;
      out_.begin[++kept] = end;
    }
    out_.refs.resize(end);
    out_.reach2.resize(kept);
    out_.begin.resize(kept + 1);
  }

  static constexpr std::uint32_t kGroup = hn::MaxLanes(Lanes()), kGroups = kLeafCapacity / kGroup;
  /// If the box of a leaf extends farther than this from the centre of the frame (struct Frame), the search tests the
  /// points of the leaf one by one. In the frame, the leaf of the queries is about 1 wide.
  static constexpr float kWide = 64;
  static constexpr std::size_t kFew = 2 * K + 16;  ///< largest number of candidates that are sorted by insertion

  void search_leaf(std::uint32_t leaf) {
    const std::uint32_t first = leaf * kLeafCapacity, queries = cell_.leaf_size(leaf);
    if (!choose_frame(leaf)) return search_in_double(first, queries);
    group_count_ = (queries + kGroup - 1) / kGroup;
    packed_.leaves = 0, packed_.farthest = 0;
    take(cell_, query_.slot, leaf);
    for (std::uint32_t g = 0; g < group_count_; ++g) {
      start(groups_[g], first + g * kGroup);
      groups_[g].try_own_leaf(d_, packed_, g * kGroup);
    }
    const auto [begin, end] = branch_around(leaf);
    for (std::uint32_t l = begin; l < end; ++l) {
      if (l == leaf) continue;
      take(cell_, query_.slot, l);
      for (std::uint32_t g = 0; g < group_count_; ++g) groups_[g].try_last_leaf(d_, packed_);
    }
    for (std::uint32_t g = 0; g < group_count_; ++g) bound(g);
    find_leaves(begin, end);
    if (!try_leaves() || packed_.farthest >= kFarthest) return search_in_double(first, queries);
    for (std::uint32_t g = 0; g < group_count_; ++g)
      settle(groups_[g], first + g * kGroup, std::min(kGroup, queries - g * kGroup));
  }

  /// Returns a range of successive leaves that includes `leaf` and holds more than k points, or all leaves of a small
  /// cell. The points of these leaves give the first finite bound of the reach of each query.
  std::pair<std::uint32_t, std::uint32_t> branch_around(std::uint32_t leaf) const {
    std::uint32_t size = 1, begin = leaf, end = leaf + 1;
    while (std::min(end * kLeafCapacity, cell_.size()) - begin * kLeafCapacity <= what_.k &&
           end - begin < cell_.leaf_count()) {
      size *= 2;
      end = std::min(leaf / size * size + size, cell_.leaf_count());
      begin = end - std::min(end, size);
    }
    return {begin, end};
  }

  /// Chooses centre and scale of the frame for the leaf of the queries. Returns false if the width of the leaf is out
  /// of range: below about 2^-300 or above about 2^300.
  bool choose_frame(std::uint32_t leaf) {
    double extent = 0;
    for (int a = 0; a < 3; ++a) {
      const double lo = cell_.leaf_box[a][leaf], hi = cell_.leaf_box[a + 3][leaf];
      query_box_.lo[a] = cell_.origin[a] + lo, query_box_.hi[a] = cell_.origin[a] + hi;
      extent = std::max(extent, hi - lo);
    }
    if (extent == 0) extent = std::max({cell_.box.extent().x, cell_.box.extent().y, cell_.box.extent().z}) / 64;
    if (extent == 0) extent = 1;
    const double power = power_of_two_below(extent);
    if (power < 0x1p-300 || power > 0x1p300) return false;
    const double scale = reciprocal_of_power(power);
    leaf_extent_ = extent * scale;
    frame_ = {query_box_.center(), scale, power * power};
    return true;
  }

  void start(Group<K>& group, std::uint32_t first) {
    group.x = to_local(d_, cell_.x + first, frame_.center.x, frame_.scale);
    group.y = to_local(d_, cell_.y + first, frame_.center.y, frame_.scale);
    group.z = to_local(d_, cell_.z + first, frame_.center.z, frame_.scale);
    group.selection.start(d_, what_.k);
    const double r = what_.radius * frame_.scale, m = r + 2 * leaf_extent_;
    limited_ = r < kFarthest;
    radius2_ = limited_ ? static_cast<float>(r * r) : kEmptyKey;
    group.radius_key = hn::Set(
        d_, limited_ ? static_cast<float>(r * r * (1 + 2 * kRelativeMargin) + m * m * kAbsoluteMargin) : kEmptyKey);
  }

  void take(const Cell& cell, std::uint32_t slot, std::uint32_t leaf) {
    pack(frame_, cell, slot, leaf, frame_.local(cell, leaf).farthest(), packed_);
  }

  /// Sets the squared distances, in the frame, beyond which the queries of group `g` need no candidate.
  void bound(std::uint32_t g) {
    limits_[g] = groups_[g].reach(d_, packed_.farthest);
    group_reach2_[g] = hn::GetLane(hn::MaxOfLanes(d_, limits_[g]));
  }
  float farthest_reach2() const { return *std::max_element(group_reach2_, group_reach2_ + group_count_); }

  /// Converts a squared distance in the frame to units of the cloud, rounded up.
  double unscaled(float reach2) const {
    return reach2 < 0.99f * kEmptyKey ? static_cast<double>(reach2) * (1 + 1e-6) * frame_.unscale2
                                      : std::numeric_limits<double>::infinity();
  }

  /// Collects the leaves that a query of any group may need, nearest first. Skips leaves [begin, end) of the query's
  /// own cell, which the caller has already searched.
  void find_leaves(std::uint32_t begin, std::uint32_t end) {
    const double reach2 = unscaled(farthest_reach2());
    if (reach2 > scratch_.near.reach2) scratch_.near.find(query_, 4 * reach2);
    const auto untried = [&](std::uint32_t slot, std::uint32_t l) {
      return slot != query_.slot || l < begin || l >= end;
    };
    constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
    collect_near_leaves(query_.directory, scratch_.near.cells, query_box_, reach2, kAll, untried, scratch_.leaves);
  }

  /// Tries the collected leaves until no further leaf can hold a neighbour. Returns false if the queries need more
  /// leaves than `packed_` has room for.
  bool try_leaves() {
    float limit = not_near(unscaled(farthest_reach2()));
    for (const std::uint64_t key : scratch_.leaves) {
      if (NearLeaf::distance2(key) > limit) break;
      const std::uint32_t slot = scratch_.near.cells[NearLeaf::place(key)].slot, leaf = NearLeaf::leaf(key);
      const Cell& cell = query_.directory.cell(slot);
      const LocalBox box = frame_.local(cell, leaf);
      bool taken = false;
      for (std::uint32_t g = 0; g < group_count_; ++g) {
        if (!groups_[g].anyone_reaches(d_, box, limits_[g])) continue;
        if (!taken) {
          if (packed_.full()) return false;
          take_within_reach(cell, slot, leaf, box.farthest());
          taken = true;
        }
        groups_[g].try_last_leaf(d_, packed_);
        bound(g);
      }
      if (taken) limit = not_near(unscaled(farthest_reach2()));
    }
    return true;
  }

  /// Packs the points of a leaf. If the leaf extends far from the leaf of the queries, keeps only the points that a
  /// query may need.
  void take_within_reach(const Cell& cell, std::uint32_t slot, std::uint32_t leaf, float farthest) {
    const float others = packed_.farthest;
    pack(frame_, cell, slot, leaf, farthest, packed_);
    if (farthest <= kWide) return;
    leave_out_beyond(1.001f * (std::sqrt(farthest_reach2()) + static_cast<float>(leaf_extent_)), others, packed_);
  }

  /// Writes the lists. Where two keys are too close to decide the order of their points, exact distances decide. If the
  /// keys cannot decide which points belong to the list, at the kth neighbour or the radius, settle_in_double()
  /// searches for the point again.
  void settle(const Group<K>& group, std::uint32_t first, std::uint32_t queries) {
    const Vec empty = hn::Set(d_, kEmptyKey), relative = hn::Set(d_, kRelativeMargin), one = hn::Set(d_, 1.0f);
    const Vec absolute = hn::Set(d_, packed_.farthest * packed_.farthest * kAbsoluteMargin);
    const Vec surely_within = hn::Set(d_, limited_ ? radius2_ * (1 - 1e-6f) : kEmptyKey);
    Vec set_unsure = hn::Zero(d_);
    std::uint64_t close_to_next[kGroup] = {};  // by lane; bit i: keys i and i + 1 are too close
    for (std::size_t i = 0; i <= K; ++i) {
      const Vec key = group.selection.list[i];
      hn::Store(key, d_, keys_[i]);
      if (i == K) break;
      const Vec next = group.selection.list[i + 1];
      const auto real = hn::Lt(key, empty);
      const auto near = hn::Le(hn::Sub(next, key), hn::MulAdd(next, relative, absolute));
      const auto close = hn::And(hn::Lt(next, empty), near);
      if (i + 1 == K) {
        set_unsure = hn::IfThenElse(close, one, set_unsure);
      } else {
        for (std::uint32_t lanes = bits_of(d_, close); lanes != 0; lanes &= lanes - 1) {
          close_to_next[__builtin_ctz(lanes)] |= std::uint64_t{1} << i;
        }
      }
      if (limited_) {
        const auto within = hn::Le(hn::MulAdd(key, hn::Set(d_, 1 + kRelativeMargin), absolute), surely_within);
        set_unsure = hn::IfThenElse(hn::AndNot(within, real), one, set_unsure);
      }
    }
    HWY_ALIGN float set_lane[kLeafCapacity], reach_lane[kLeafCapacity];
    hn::Store(set_unsure, d_, set_lane);
    hn::Store(group.reach(d_, packed_.farthest), d_, reach_lane);
    make_room(queries);
    for (std::uint32_t q = 0; q < queries; ++q) {
      if (set_lane[q] != 0 && is_wanted(first + q)) {
        out_.refs.resize(written_);
        settle_in_double(group, first + q, q, reach_lane[q]);
        make_room(queries - q - 1);
      } else {
        write_lane(first + q, q, close_to_next[q] >> (K - what_.k));
        out_.reach2.push_back(unscaled(reach_lane[q]));
        out_.begin.push_back(static_cast<std::uint32_t>(written_));
      }
    }
    out_.refs.resize(written_);
  }

  /// Extends out_.refs for the lists of `queries` queries, so that the lists are written in place. Copying lists whose
  /// values have just been written one by one would stall the processor.
  void make_room(std::uint32_t queries) {
    written_ = out_.refs.size();
    out_.refs.resize(written_ + queries * K);
  }

  void write_lane(std::uint32_t point, std::uint32_t lane, std::uint64_t close_to_next) {
    NeighborRef* const refs = out_.refs.data() + written_;
    std::size_t size = 0;
    for (std::size_t i = K - what_.k; i < K && keys_[i][lane] < kEmptyKey; ++i) {
      const std::uint32_t number = std::bit_cast<std::uint32_t>(keys_[i][lane]) & (kCandidates - 1);
      refs[size++] = packed_.first[number / kLeafCapacity] + number % kLeafCapacity;
    }
    if (close_to_next != 0) order_runs(query_.directory, cell_.position(point), close_to_next, refs);
    written_ += size;
  }

  /// Searches again for the neighbours of one query among the packed candidates, by the exact distances of the
  /// candidates.
  void settle_in_double(const Group<K>& group, std::uint32_t point, std::uint32_t lane, float reach) {
    ++scratch_.settled_in_double;
    const std::size_t near = find_near(group, lane, reach);
    near <= kFew ? settle_few(point, near) : settle_many(point, near);
  }

  /// Writes to near_ the numbers of all packed candidates that may be neighbours of the query: those whose squared
  /// distance in single precision is at most `reach` and a margin for rounding. Returns how many there are.
  std::size_t find_near(const Group<K>& group, std::uint32_t lane, float reach) {
    const float limit = reach * (1 + 2 * kRelativeMargin) + packed_.farthest * packed_.farthest * 2 * kAbsoluteMargin;
    const auto all = [&](Vec v) HWY_ATTR { return hn::Set(d_, lane_of(v, lane)); };
    return packed_within(d_, packed_, all(group.x), all(group.y), all(group.z), limit, near_.data());
  }

  /// Calls use(candidate) for each candidate of near_ that is a point, not padding, and not the query itself.
  template <class Use>
  void for_each_near(std::uint32_t point, std::size_t near, Use use) const {
    const Vec3 p = cell_.position(point);
    for (std::size_t n = 0; n < near; ++n) {
      const NeighborRef ref = packed_.first[near_[n] / kLeafCapacity] + near_[n] % kLeafCapacity;
      if (index_of(ref) >= query_.directory.cell(slot_of(ref)).size()) continue;
      const Candidate c = candidate_from(query_.directory, ref, p);
      if (c.row != cell_.row[point]) use(c);
    }
  }

  void settle_few(std::uint32_t point, std::size_t near) {
    std::array<Candidate, K> list;
    std::size_t size = 0;
    for_each_near(point, near, [&](const Candidate& c) {
      if (c.distance2 <= what_.radius2()) size = insert_sorted(c, list.data(), size, what_.k);
    });
    for (std::size_t i = 0; i < size; ++i) out_.refs.push_back(list[i].ref);
    finish_point(size == what_.k ? list[size - 1].distance2 : what_.radius2());
  }

  void settle_many(std::uint32_t point, std::size_t near) {
    scratch_.best.start(what_);
    for_each_near(point, near, [&](const Candidate& c) { scratch_.best.offer(c); });
    append_best(what_, scratch_, out_);
  }

  /// Searches the points of a leaf one by one in double, because their neighbours are too many or too spread for the
  /// vector code.
  void search_in_double(std::uint32_t first, std::uint32_t queries) {
    for (std::uint32_t q = first; q < first + queries; ++q) {
      if (!is_wanted(q)) {
        finish_point(0);
        continue;
      }
      ++scratch_.settled_in_double;
      search_point_plainly(query_, q, scratch_);
      append_best(what_, scratch_, out_);
    }
  }

  void finish_point(double reach2) {
    out_.reach2.push_back(reach2);
    out_.begin.push_back(static_cast<std::uint32_t>(out_.refs.size()));
  }

  bool is_wanted(std::uint32_t point) const { return (wanted_ >> point % kLeafCapacity & 1) != 0; }

  float lane_of(Vec v, std::uint32_t lane) const {
    HWY_ALIGN float values[kLeafCapacity];
    hn::Store(v, d_, values);
    return values[lane];
  }

  const Lanes d_{};
  const CellQuery query_;
  const Cell& cell_;
  const Neighborhood what_;
  SearchScratch& scratch_;
  CellNeighbors& out_;
  std::uint32_t wanted_ = ~0u;  ///< one bit for each wanted point of the leaf; the lists of other points may be wrong
  double leaf_extent_ = 1;
  bool limited_ = false;
  float radius2_ = 0;
  Box query_box_;
  Frame frame_{};
  Packed packed_;
  Group<K> groups_[kGroups];
  Vec limits_[kGroups];  ///< for each query: the squared distance in the frame beyond which the query needs no point
  float group_reach2_[kGroups];  ///< for each group: the largest squared reach of its queries
  std::uint32_t group_count_ = 0;
  HWY_ALIGN float keys_[K + 1][kLeafCapacity];
  std::size_t written_ = 0;                      ///< number of neighbours written to out_.refs, which may be longer
  std::array<std::uint16_t, kCandidates> near_;  ///< numbers of packed candidates
};

void search_lanes(const CellQuery& query, const CellSubset& points, SearchScratch& scratch, CellNeighbors& out) {
  if (query.what.k <= 8) return CellSearch<8>(query, scratch, out).run(points);
  if (query.what.k <= 16) return CellSearch<16>(query, scratch, out).run(points);
  if (query.what.k <= 32) return CellSearch<32>(query, scratch, out).run(points);
  return CellSearch<64>(query, scratch, out).run(points);
}

}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
HWY_AFTER_NAMESPACE();
#else
namespace pointsweep {
namespace HWY_NAMESPACE {
void search_lanes(const CellQuery& query, const CellSubset& points, SearchScratch& scratch, CellNeighbors& out) {
  search_plainly(query, points, kAllLists, scratch, out);
}
}  // namespace HWY_NAMESPACE
}  // namespace pointsweep
#endif

#if HWY_ONCE
namespace pointsweep {
HWY_EXPORT(search_lanes);

/// With at most kMostInLanes neighbours per point, the lists of a whole cell are small, so this function ignores
/// `most`.
std::uint32_t search(const CellQuery& query, const CellSubset& points, std::uint64_t most, SearchScratch& scratch,
                     CellNeighbors& out) {
  out.refs.clear();
  out.reach2.clear();
  out.begin.assign(1, 0);
  if (points.size() == 0) return 0;
  if (query.what.k > kMostInLanes) return search_gathered(query, points, most, scratch, out);
  if (query.what.k == 0) return search_plainly(query, points, most, scratch, out);
  HWY_DYNAMIC_DISPATCH(search_lanes)(query, points, scratch, out);
  return points.size();
}

}  // namespace pointsweep
#endif
