// SPDX-License-Identifier: MIT
#include "pointsweep/operators/nearest/point_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/operators/nearest/place_group.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kCellPoints = 512, kSlabCells = 64, kLeafPoints = 8;
constexpr std::size_t kLeastCells = 2 * kSlabCells;
/// Limits of the largest number of places that are searched together, which depends on the number of all places.
constexpr std::size_t kLeastGroup = 512, kMostGroup = 8192;
/// Largest number of places that are searched together for all points within a distance.
constexpr std::size_t kPlacesWithin = 64;

bool meet(const Box& a, const Box& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
         b.lo.z <= a.hi.z;
}

bool holds(const Box& b, Vec3 p) {
  return p.x >= b.lo.x && p.x <= b.hi.x && p.y >= b.lo.y && p.y <= b.hi.y && p.z >= b.lo.z && p.z <= b.hi.z;
}

/// Returns a box that holds all points whose distance from a place, as distance2() rounds it, is at most the radius.
/// The factor and nextafter() outweigh all rounding. The reach is at least 1e-150, since squares of smaller differences
/// may underflow.
Box reach_of(Vec3 place, double radius) {
  const double reach = std::max(radius * (1 + 0x1p-40), 1e-150);
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Box box;
  for (int a = 0; a < 3; ++a) {
    box.lo[a] = std::nextafter(place[a] - reach, -kInf);
    box.hi[a] = std::nextafter(place[a] + reach, kInf);
  }
  return box;
}

}  // namespace

/// The points of a cell in memory.
class PointCells::Tree {
 public:
  Tree(std::vector<CellPoint> points, Space space)
      : points_(std::move(points)),
        in_plane_(space == Space::plane),
        leaves_(points_, HalvedBoxes::levels_for(points_.size(), kLeafPoints), in_plane_) {}

  void nearest(Vec3 place, NearestSoFar& nearest) const {
    leaves_.nearest_first(
        place, [&] { return nearest.worst(); },
        [&](std::size_t leaf) {
          for (std::size_t i = leaves_.begin(leaf); i < leaves_.begin(leaf + 1); ++i)
            nearest.see(distance2(flat(i), place), points_[i]);
          return true;
        });
  }

  /// Calls use(point, position) for each point of the boxes for which `wanted` is true; `position` has z = 0 in
  /// Space::plane. Ends and returns false when `use` returns false.
  template <class Wanted, class Use>
  bool all_of(Wanted wanted, Use use) const {
    return leaves_.all_of(wanted, [&](std::size_t leaf) {
      for (std::size_t i = leaves_.begin(leaf); i < leaves_.begin(leaf + 1); ++i)
        if (!use(points_[i], flat(i))) return false;
      return true;
    });
  }

 private:
  Vec3 flat(std::size_t i) const {
    const Vec3 p = points_[i].position;
    return in_plane_ ? Vec3{p.x, p.y, 0} : p;
  }

  std::vector<CellPoint> points_;
  bool in_plane_;
  HalvedBoxes leaves_;
};

PointCells::PointCells(Space space, int axis, std::uint64_t memory_bytes, std::unique_ptr<Scratch> scratch)
    : space_(space),
      axis_(axis),
      most_loaded_(std::max<std::size_t>(
          kLeastCells, static_cast<std::size_t>(memory_bytes / (least_bytes() / (kLeastCells + kSlabCells))))),
      scratch_(std::move(scratch)) {}

PointCells::PointCells(PointCells&&) noexcept = default;
PointCells::~PointCells() = default;

/// Counts the bytes of the least number of cells, with their boxes and nodes in loaded_, and of the slab being filled.
std::uint64_t PointCells::least_bytes() {
  constexpr std::size_t kBoxes = 2 * 2 * kCellPoints / kLeafPoints;
  return (kLeastCells + kSlabCells) * (kCellPoints * sizeof(CellPoint) + kBoxes * sizeof(Box) + 128);
}

void PointCells::add(Vec3 position, std::uint64_t row) {
  slab_.push_back({position, row});
  if (slab_.size() == kSlabCells * kCellPoints) end_slab();
}

void PointCells::finish() {
  if (!slab_.empty()) end_slab();
  free_memory_of(slab_);
}

void PointCells::end_slab() {
  HalvedBoxes parts(slab_, HalvedBoxes::levels_for(slab_.size(), kCellPoints), space_ == Space::plane);
  Box box;
  for (const CellPoint& p : slab_) box.include(flat(p.position));
  const std::size_t first_cell = cells_.size();
  for (std::size_t c = 0; c < parts.parts(); ++c)
    cells_.push_back({count_ + parts.begin(c), parts.begin(c + 1) - parts.begin(c), nullptr});
  scratch_->append(std::as_bytes(std::span(slab_)));
  count_ += slab_.size();
  slabs_.push_back({box, first_cell, std::move(parts)});
  slab_.clear();
}

/// Returns the index of the first slab that ends at or after a coordinate on the axis; the last slab if there is none.
std::size_t PointCells::slab_at(double along) const {
  const auto at = std::ranges::lower_bound(slabs_, along, {}, [this](const Slab& s) { return s.box.hi[axis_]; });
  return std::min(static_cast<std::size_t>(at - slabs_.begin()), slabs_.size() - 1);
}

/// Returns the points of a cell. If it has to read them, it drops the cells farthest from `near` to make room.
const PointCells::Tree& PointCells::load(std::size_t cell, std::size_t near) {
  Cell& wanted = cells_[cell];
  if (wanted.loaded) return *wanted.loaded;
  while (loaded_.size() >= most_loaded_) {
    const std::size_t first = *loaded_.begin(), last = *loaded_.rbegin();
    const std::size_t before = near > first ? near - first : 0, behind = last > near ? last - near : 0;
    const std::size_t farthest = before >= behind ? first : last;
    cells_[farthest].loaded.reset();
    loaded_.erase(farthest);
  }
  std::vector<CellPoint> points(wanted.count);
  scratch_->read(wanted.first * sizeof(CellPoint), std::as_writable_bytes(std::span(points)));
  wanted.loaded = std::make_unique<const Tree>(std::move(points), space_);
  loaded_.insert(cell);
  return *wanted.loaded;
}

/// Answers questions in parallel with the cells in memory, then loads the missing cells for the remaining questions,
/// and so on. Once more cells have been loaded in all than fit in memory, answers the remaining questions one after
/// another.
void PointCells::answer_all(std::size_t n, std::size_t at_once, const std::function<Vec3(std::size_t i)>& place,
                            const Answer& answer) {
  std::vector<std::size_t> open(n);
  std::iota(open.begin(), open.end(), std::size_t{0});
  for (std::size_t loads = 0; !open.empty();) {
    const std::size_t parts = (open.size() + at_once - 1) / at_once;
    std::vector<std::vector<std::size_t>> left(parts), missing(parts);
    parallel_for(parts, [&](std::size_t part, unsigned) {
      View view(*this);
      const std::size_t end = std::min(open.size(), (part + 1) * at_once);
      for (std::size_t i = part * at_once; i < end; ++i)
        if (!answer(open[i], view)) left[part].push_back(open[i]);
      missing[part] = std::move(view.missing_);
    });
    std::set<std::size_t> wanted;
    open.clear();
    for (std::size_t part = 0; part < parts; ++part) {
      open.insert(open.end(), left[part].begin(), left[part].end());
      wanted.insert(missing[part].begin(), missing[part].end());
    }
    loads += wanted.size();
    if (loads > most_loaded_) break;
    for (const std::size_t cell : wanted) load(cell, cell);
  }
  View view(*this);
  view.loading_ = this;
  for (const std::size_t i : open) {
    view.near_ = slabs_[slab_at(place(i)[axis_])].first_cell;
    answer(i, view);
  }
}

void PointCells::nearest_of_all(std::span<const Vec3> places, const NearestWanted& wanted,
                                const std::function<void(std::size_t, const std::vector<CellNeighbor>&)>& use) {
  if (places.empty()) return;
  std::vector<CellPoint> asked(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) asked[i] = {flat(places[i]), i};
  const std::size_t most = std::clamp(asked.size() / (4 * thread_count()), kLeastGroup, kMostGroup);
  const HalvedBoxes parts(asked, HalvedBoxes::levels_for(asked.size(), most), false);
  std::vector<PlaceGroup> groups;
  for (std::size_t g = 0; g < parts.parts(); ++g)
    groups.emplace_back(std::span(asked).subspan(parts.begin(g), parts.begin(g + 1) - parts.begin(g)), wanted,
                        space_ == Space::plane);
  answer_all(
      groups.size(), 1, [&](std::size_t g) { return groups[g].first(); },
      [&](std::size_t g, View& view) { return groups[g].answer(view, use); });
}

void PointCells::nearest_within(std::span<const Vec3> places, double radius,
                                const std::function<void(WithinPlaces)>& use) {
  if (places.empty()) return;
  std::vector<CellPoint> asked(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) asked[i] = {flat(places[i]), i};
  const HalvedBoxes parts(asked, HalvedBoxes::levels_for(asked.size(), kPlacesWithin), false);
  const double most2 = radius * radius;
  const auto answer = [&](std::size_t part, View& view) {
    WithinPlaces found;
    bool complete = true;
    for (std::size_t i = parts.begin(part); i < parts.begin(part + 1); ++i) {
      const Vec3 place = asked[i].position;
      const std::size_t before = found.neighbors.size();
      const bool seen = view.within(reach_of(place, radius), [&](const CellPoint& point) {
        const double d2 = distance2(flat(point.position), place);
        if (d2 <= most2) found.neighbors.push_back({d2, point.position, point.row});
      });
      complete = complete && seen;
      std::sort(found.neighbors.begin() + static_cast<std::ptrdiff_t>(before), found.neighbors.end());
      found.places.push_back(asked[i].row);
      found.counts.push_back(found.neighbors.size() - before);
    }
    if (complete) use(std::move(found));
    return complete;
  };
  const auto first_of = [&](std::size_t part) { return asked[parts.begin(part)].position; };
  answer_all(parts.parts(), 1, first_of, answer);
}

const PointCells::Tree* PointCells::View::tree(std::size_t cell) {
  stop_if_cancelled();
  if (const Tree* known = of_.cells_[cell].loaded.get()) return known;
  if (loading_ != nullptr) return &loading_->load(cell, near_);
  missing_.push_back(cell);
  return nullptr;
}

std::span<const PointCells::Slab> PointCells::View::slabs_between(double lo, double hi) const {
  if (of_.slabs_.empty()) return {};
  const std::span<const Slab> from = std::span(of_.slabs_).subspan(of_.slab_at(lo));
  const auto end = std::ranges::upper_bound(from, hi, {}, [this](const Slab& s) { return s.box.lo[of_.axis_]; });
  return from.first(static_cast<std::size_t>(end - from.begin()));
}

/// Searches from the slab of the place to both sides along the axis, as long as a slab may contain a point as near as
/// the k points found so far; within a slab, nearest cells first. Ends at a cell that is not in memory if fewer than k
/// points are found. Otherwise goes on, so that all missing cells are recorded at once.
const std::vector<CellNeighbor>* PointCells::View::nearest(Vec3 place, const NearestWanted& wanted) {
  nearest_.begin(wanted);
  const std::vector<Slab>& slabs = of_.slabs_;
  const Vec3 p = of_.flat(place);
  const double at = p[of_.axis_];
  const auto worst = [&] { return nearest_.worst(); };
  const std::size_t near = slabs.empty() ? 0 : of_.slab_at(at);
  std::size_t before = near, behind = near;  // the slabs from `before` to `behind` - 1 have been searched
  bool complete = true;
  while (before > 0 || behind < slabs.size()) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const double up = behind == near ? 0 : behind < slabs.size() ? slabs[behind].box.lo[of_.axis_] - at : kNone;
    const double down = before > 0 ? at - slabs[before - 1].box.hi[of_.axis_] : kNone;
    const bool goes_up = behind == near || up <= down;
    if (behind != near && (goes_up ? up * up : down * down) > worst()) break;
    const Slab& slab = slabs[goes_up ? behind++ : --before];
    const bool goes_on = slab.cells.nearest_first(p, worst, [&](std::size_t c) {
      const Tree* const points = tree(slab.first_cell + c);
      if (points == nullptr)
        complete = false;
      else
        points->nearest(p, nearest_);
      return complete || nearest_.full();
    });
    if (!goes_on) return nullptr;
  }
  return complete ? &nearest_.found() : nullptr;
}

bool PointCells::View::within(const Box& box, const std::function<void(const CellPoint&)>& use) {
  bool complete = true;
  const auto wanted = [&](const Box& b) { return meet(b, box); };
  for (const Slab& slab : slabs_between(box.lo[of_.axis_], box.hi[of_.axis_])) {
    slab.cells.all_of(wanted, [&](std::size_t c) {
      const Tree* const points = tree(slab.first_cell + c);
      if (points == nullptr) complete = false;
      if (complete)
        points->all_of(wanted, [&](const CellPoint& point, Vec3 at) {
          if (holds(box, at)) use(point);
          return true;
        });
      return true;
    });
  }
  return complete;
}

PointCells::View::Collected PointCells::View::collect(const Box& places, const NearestBound& bound, std::size_t most,
                                                      std::vector<CellPoint>& to) {
  bool complete = true;
  const auto wanted = [&](const Box& b) { return !bound.out(b); };
  const auto take = [&](const CellPoint& point, Vec3 at) {
    if (!bound.out(at)) to.push_back(point);
    return to.size() <= most;
  };
  const double lo = places.lo[of_.axis_] - bound.reach(), hi = places.hi[of_.axis_] + bound.reach();
  for (const Slab& slab : slabs_between(lo, hi)) {
    const bool goes_on = slab.cells.all_of(wanted, [&](std::size_t c) {
      const Tree* const points = tree(slab.first_cell + c);
      if (points == nullptr) complete = false;
      return points == nullptr || points->all_of(wanted, take);
    });
    if (!goes_on) return Collected::too_many;
  }
  return complete ? Collected::all : Collected::lacks_cells;
}

}  // namespace pointsweep
