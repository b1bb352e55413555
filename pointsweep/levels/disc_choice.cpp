// SPDX-License-Identifier: MIT
#include "pointsweep/levels/disc_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/box.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kLeastBuckets = 1024;
/// Ratio of the width of a cell to the spacing. The margin makes up for rounding: points nearer than the spacing always
/// lie in the same cell or in adjacent cells.
constexpr double kSlack = 1 + 1e-9;

constexpr std::uint64_t kAllRanks = std::numeric_limits<std::uint64_t>::max();
/// Number of points expected below the first limit of ranks, and the factor from one limit to the next.
constexpr std::uint64_t kFirstCandidates = 64 << 10, kNextLimit = 16;
/// When blocks bring more candidates than this, the limit of ranks is lowered.
constexpr std::size_t kMostCandidates = 256 << 10;
/// Parts of at most this many places are not halved; each place is tested.
constexpr std::size_t kFewPlaces = 32;

struct Candidate {
  std::uint64_t rank, row;
  GridPoint point;
  friend bool operator<(const Candidate& a, const Candidate& b) {
    return std::tie(a.rank, a.point, a.row) < std::tie(b.rank, b.point, b.row);
  }
};

/// Returns the squared distance from a point to the farthest corner of a box, rounded. No place in the box has a
/// greater distance2() from the point.
double farthest2(const Box& box, Vec3 p) {
  const Vec3 far{std::max(p.x - box.lo.x, box.hi.x - p.x), std::max(p.y - box.lo.y, box.hi.y - p.y),
                 std::max(p.z - box.lo.z, box.hi.z - p.z)};
  return (far.x * far.x + far.y * far.y) + far.z * far.z;
}

/// Finds the places of a block that no kept point covers. Halves the block recursively. A kept point near enough to all
/// places of a half covers these places at once. The places of a half are compared only with the kept points near that
/// half.
class UncoveredPlaces {
 public:
  /// Returns the numbers of the uncovered places, ascending, valid until the next call. `box`: a box around all places.
  std::span<const std::uint32_t> find(std::span<const Vec3> places, const Box& box, const KeptGrid& kept);

 private:
  void find_in(std::size_t first, std::size_t count, std::size_t first_near);

  std::span<const Vec3> places_;
  double spacing2_ = 0;
  std::vector<Vec3> near_;  ///< a stack: the points near a half follow the points near the half that contains it
  std::vector<std::uint32_t> uncovered_;
};

std::span<const std::uint32_t> UncoveredPlaces::find(std::span<const Vec3> places, const Box& box,
                                                     const KeptGrid& kept) {
  places_ = places;
  spacing2_ = kept.spacing2();
  uncovered_.clear();
  kept.find_near(box, near_);
  find_in(0, places.size(), 0);
  return uncovered_;
}

void UncoveredPlaces::find_in(std::size_t first, std::size_t count, std::size_t first_near) {
  Box box;
  for (std::size_t i = first; i < first + count; ++i) box.include(places_[i]);
  const std::size_t end_near = near_.size();
  for (std::size_t i = first_near; i < end_near; ++i) {
    const Vec3 p = near_[i];
    if (distance2(box, p) >= spacing2_) continue;
    if (farthest2(box, p) < spacing2_) return near_.resize(end_near);
    near_.push_back(p);
  }
  if (near_.size() == end_near) {
    for (std::size_t i = first; i < first + count; ++i) uncovered_.push_back(static_cast<std::uint32_t>(i));
  } else if (count > kFewPlaces) {
    find_in(first, count / 2, end_near);
    find_in(first + count / 2, count - count / 2, end_near);
  } else {
    std::array<bool, kFewPlaces> covered{};
    for (std::size_t n = end_near; n < near_.size(); ++n)
      for (std::size_t i = 0; i < count; ++i) covered[i] |= distance2(near_[n], places_[first + i]) < spacing2_;
    for (std::size_t i = 0; i < count; ++i)
      if (!covered[i]) uncovered_.push_back(static_cast<std::uint32_t>(first + i));
  }
  near_.resize(end_near);
}

class Choice {
 public:
  Choice(const CurvePoints& points, NodeRows rows, KeptGrid& kept)
      : points_(points), rows_(rows), kept_(kept), workers_(thread_count()) {
    for (std::uint64_t block = rows.first / CurvePoints::kBlockRows;
         block * CurvePoints::kBlockRows < rows.first + rows.count; ++block)
      blocks_.push_back(block);
  }

  std::optional<std::vector<KeptPoint>> run(std::size_t most) {
    limit_ = rows_.count <= kFirstCandidates ? kAllRanks : kAllRanks / rows_.count * kFirstCandidates;
    for (;;) {
      gather();
      std::sort(candidates_.begin(), candidates_.end());
      for (const Candidate& c : candidates_) {
        const Vec3 place = points_.grid().place(c.point);
        if (kept_.covers(place)) continue;
        if (chosen_.size() == most) return {};
        kept_.add(place);
        chosen_.push_back({c.row, c.point});
      }
      if (limit_ == kAllRanks) return std::move(chosen_);
      limit_ = limit_ > kAllRanks / kNextLimit ? kAllRanks : limit_ * kNextLimit;
    }
  }

 private:
  struct Worker {
    std::vector<GridPoint> points;
    std::vector<Vec3> places;
    UncoveredPlaces uncovered;
  };
  struct Found {
    std::vector<Candidate> candidates;
    bool has_uncovered = false;
  };

  /// Collects all uncovered points whose rank is within the limit, and drops the blocks without uncovered points. Too
  /// many candidates lower the limit.
  void gather() {
    candidates_.clear();
    std::vector<std::uint64_t> live;
    const std::size_t group = 16 * workers_.size();
    for (std::size_t first = 0; first < blocks_.size(); first += group) {
      stop_if_cancelled();
      std::vector<Found> found(std::min(group, blocks_.size() - first));
      parallel_for(found.size(),
                   [&](std::size_t i, unsigned worker) { find(blocks_[first + i], workers_[worker], found[i]); });
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (found[i].has_uncovered) live.push_back(blocks_[first + i]);
        candidates_.insert(candidates_.end(), found[i].candidates.begin(), found[i].candidates.end());
      }
      if (candidates_.size() > kMostCandidates) lower_limit();
    }
    blocks_ = std::move(live);
  }

  void find(std::uint64_t block, Worker& worker, Found& found) const {
    const std::uint64_t start = block * CurvePoints::kBlockRows;
    const std::uint64_t first = std::max(start, rows_.first);
    const std::uint64_t end = std::min(start + CurvePoints::kBlockRows, rows_.first + rows_.count);
    worker.points.resize(static_cast<std::size_t>(end - first));
    worker.places.resize(worker.points.size());
    points_.read(first, worker.points);
    for (std::size_t i = 0; i < worker.points.size(); ++i) worker.places[i] = points_.grid().place(worker.points[i]);
    const auto uncovered = worker.uncovered.find(worker.places, points_.block_box(block), kept_);
    found.has_uncovered = !uncovered.empty();
    for (const std::uint32_t i : uncovered) {
      const std::uint64_t rank = rank_of(worker.points[i]);
      if (rank <= limit_) found.candidates.push_back({rank, first + i, worker.points[i]});
    }
  }

  /// Lowers the limit to the rank of candidate kMostCandidates / 2 in the order of ranks, and drops the candidates of
  /// higher ranks. Of candidates at one place, which have the same rank, only the first stays.
  void lower_limit() {
    const auto middle = candidates_.begin() + kMostCandidates / 2;
    std::ranges::nth_element(candidates_, middle, {}, &Candidate::rank);
    limit_ = middle->rank;
    std::erase_if(candidates_, [&](const Candidate& c) { return c.rank > limit_; });
    // Only the first of the points at one place may be kept.
    std::sort(candidates_.begin(), candidates_.end());
    const auto same = [](const Candidate& a, const Candidate& b) { return a.point == b.point; };
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end(), same), candidates_.end());
  }

  const CurvePoints& points_;
  const NodeRows rows_;
  KeptGrid& kept_;
  std::vector<Worker> workers_;
  std::vector<std::uint64_t> blocks_;  ///< blocks that may have uncovered points
  std::uint64_t limit_ = 0;            ///< highest rank of a candidate
  std::vector<Candidate> candidates_;
  std::vector<KeptPoint> chosen_;
};

}  // namespace

KeptGrid::KeptGrid(double spacing, Vec3 corner)
    : spacing2_(spacing * spacing),
      cells_per_step_(1 / (spacing * kSlack)),
      corner_(corner),
      first_(kLeastBuckets, kNone) {}

KeptGrid::Cell KeptGrid::cell_of(Vec3 place) const {
  const Vec3 at = cells_per_step_ * (place - corner_);
  return {static_cast<std::int64_t>(std::floor(at.x)), static_cast<std::int64_t>(std::floor(at.y)),
          static_cast<std::int64_t>(std::floor(at.z))};
}

std::size_t KeptGrid::bucket_of(const Cell& cell) const {
  const auto mixed = static_cast<std::uint64_t>(cell[0]) * 0x9e3779b97f4a7c15u +
                     static_cast<std::uint64_t>(cell[1]) * 0xbf58476d1ce4e5b9u +
                     static_cast<std::uint64_t>(cell[2]) * 0x94d049bb133111ebu;
  return static_cast<std::size_t>((mixed ^ mixed >> 32) & (first_.size() - 1));
}

void KeptGrid::add(Vec3 point) {
  if (points_.size() == first_.size()) grow();
  std::uint32_t& first = first_[bucket_of(cell_of(point))];
  next_.push_back(first);
  first = static_cast<std::uint32_t>(points_.size());
  points_.push_back(point);
}

void KeptGrid::grow() {
  first_.assign(4 * first_.size(), kNone);
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    std::uint32_t& first = first_[bucket_of(cell_of(points_[i]))];
    next_[i] = first;
    first = i;
  }
}

/// Returns whether `use` returns true for a point of the cell, or for a point of another cell in the bucket of the
/// cell.
template <class Use>
bool KeptGrid::any_of_cell(const Cell& cell, const Use& use) const {
  for (std::uint32_t i = first_[bucket_of(cell)]; i != kNone; i = next_[i])
    if (use(points_[i])) return true;
  return false;
}

bool KeptGrid::covers(Vec3 place) const {
  const auto [x, y, z] = cell_of(place);
  // 0 is first, since the cell of the place itself holds the covering point most often.
  constexpr std::int64_t kNear[] = {0, -1, 1};
  for (const std::int64_t dx : kNear)
    for (const std::int64_t dy : kNear)
      for (const std::int64_t dz : kNear)
        if (any_of_cell({x + dx, y + dy, z + dz}, [&](Vec3 p) { return distance2(p, place) < spacing2_; })) return true;
  return false;
}

void KeptGrid::find_near(const Box& box, std::vector<Vec3>& near) const {
  near.clear();
  Cell lo = cell_of(box.lo), hi = cell_of(box.hi);
  for (std::size_t axis = 0; axis < 3; ++axis) --lo[axis], ++hi[axis];
  const std::int64_t cells = (hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1);
  const auto take = [&](Vec3 p) {
    if (distance2(box, p) < spacing2_) near.push_back(p);
    return false;
  };
  if (cells > static_cast<std::int64_t>(points_.size())) {
    for (const Vec3 p : points_) take(p);
    return;
  }
  for (Cell cell = lo; cell[0] <= hi[0]; ++cell[0])
    for (cell[1] = lo[1]; cell[1] <= hi[1]; ++cell[1])
      for (cell[2] = lo[2]; cell[2] <= hi[2]; ++cell[2]) any_of_cell(cell, take);
}

std::optional<std::vector<KeptPoint>> choose_discs(const CurvePoints& points, NodeRows rows, KeptGrid& kept,
                                                   std::size_t most) {
  return Choice(points, rows, kept).run(most);
}

}  // namespace pointsweep
