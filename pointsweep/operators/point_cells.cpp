// SPDX-License-Identifier: MIT
#include "pointsweep/operators/point_cells.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kCellPoints = 512, kSlabCells = 64, kLeafPoints = 8;
constexpr std::size_t kLeastCells = 2 * kSlabCells;
constexpr std::size_t kQuestionsAtOnce = 256;

bool holds(const Box& b, Vec3 p) {
  return p.x >= b.lo.x && p.x <= b.hi.x && p.y >= b.lo.y && p.y <= b.hi.y && p.z >= b.lo.z && p.z <= b.hi.z;
}

}  // namespace

bool CellNeighbor::operator<(const CellNeighbor& other) const {
  const auto key = [](const CellNeighbor& n) {
    return std::tuple(n.distance2, n.position.x, n.position.y, n.position.z, n.row);
  };
  return key(*this) < key(other);
}

unsigned HalvedBoxes::levels_for(std::size_t points, std::size_t most) {
  unsigned levels = 0;
  while (((points - 1) >> levels) >= most) ++levels;
  return levels;
}

HalvedBoxes::HalvedBoxes(std::span<CellPoint> points, unsigned levels, bool in_plane)
    : points_(points.size()), levels_(levels), boxes_((std::size_t{2} << levels) - 1) {
  for (unsigned level = 0; level <= levels_; ++level) {
    for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
      const std::span<CellPoint> part =
          points.subspan(part_begin(level, j), part_begin(level, j + 1) - part_begin(level, j));
      Box& own = boxes_[(std::size_t{1} << level) - 1 + j];
      for (const CellPoint& p : part) own.include(in_plane ? Vec3{p.position.x, p.position.y, 0} : p.position);
      if (level == levels_) continue;
      const std::size_t middle = part_begin(level + 1, 2 * j + 1) - part_begin(level, j);
      std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(),
                       [axis = own.longest_axis()](const CellPoint& a, const CellPoint& b) {
                         return a.position[axis] < b.position[axis];
                       });
    }
  }
}

bool HalvedBoxes::meet(const Box& a, const Box& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
         b.lo.z <= a.hi.z;
}

/// The points of a cell in memory.
class PointCells::Tree {
 public:
  Tree(std::vector<CellPoint> points, Space space)
      : points_(std::move(points)),
        in_plane_(space == Space::plane),
        leaves_(points_, HalvedBoxes::levels_for(points_.size(), kLeafPoints), in_plane_) {}

  /// `found` stays in order, of at most k.
  void nearest(Vec3 place, std::size_t k, double most2, std::vector<CellNeighbor>& found) const {
    const auto worst = [&] { return found.size() == k ? found.back().distance2 : most2; };
    leaves_.nearest_first(place, worst, [&](std::size_t leaf) {
      for (std::size_t i = leaves_.begin(leaf); i < leaves_.begin(leaf + 1); ++i) {
        const CellNeighbor next{distance2(flat(i), place), points_[i].position, points_[i].row};
        if (next.distance2 > most2 || (found.size() == k && !(next < found.back()))) continue;
        if (found.size() == k) found.pop_back();
        found.insert(std::upper_bound(found.begin(), found.end(), next), next);
      }
      return true;
    });
  }

  void within(const Box& box, const std::function<void(const CellPoint&)>& use) const {
    leaves_.all_within(box, [&](std::size_t leaf) {
      for (std::size_t i = leaves_.begin(leaf); i < leaves_.begin(leaf + 1); ++i)
        if (holds(box, flat(i))) use(points_[i]);
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

/// Of the cells, with their boxes and the nodes of the map that holds them; and of the slab that grows.
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
  slab_ = {};
}

void PointCells::end_slab() {
  HalvedBoxes parts(slab_, HalvedBoxes::levels_for(slab_.size(), kCellPoints), space_ == Space::plane);
  Box box;
  for (const CellPoint& p : slab_) box.include(flat(p.position));
  const std::size_t first_cell = cells_.size();
  for (std::size_t c = 0; c < std::size_t{1} << parts.levels(); ++c)
    cells_.push_back({count_ + parts.begin(c), parts.begin(c + 1) - parts.begin(c), nullptr});
  scratch_->append(std::as_bytes(std::span(slab_)));
  count_ += slab_.size();
  slabs_.push_back({box, first_cell, std::move(parts)});
  slab_.clear();
}

/// The first slab that ends at or behind a place along the axis, or the last one.
std::size_t PointCells::slab_at(double along) const {
  const auto at = std::ranges::lower_bound(slabs_, along, {}, [this](const Slab& s) { return s.box.hi[axis_]; });
  return std::min(static_cast<std::size_t>(at - slabs_.begin()), slabs_.size() - 1);
}

/// Makes room by dropping what is farthest from `near` along the axis.
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

/// In parallel with what is in memory, then what was missing is loaded for those that are left, and so on; where that
/// does not fit, one after another.
void PointCells::answer_all(std::size_t n, const std::function<Vec3(std::size_t i)>& place, const Answer& answer) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> open(n), missing;
  std::iota(open.begin(), open.end(), std::size_t{0});
  for (std::size_t loads = 0; !open.empty();) {
    missing.assign(open.size(), kNone);
    parallel_for((open.size() + kQuestionsAtOnce - 1) / kQuestionsAtOnce, [&](std::size_t part, unsigned) {
      View view(*this);
      const std::size_t end = std::min(open.size(), (part + 1) * kQuestionsAtOnce);
      for (std::size_t i = part * kQuestionsAtOnce; i < end; ++i)
        if (!answer(open[i], view)) missing[i] = view.missing_;
    });
    std::set<std::size_t> wanted;
    std::size_t left = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (missing[i] == kNone) continue;
      wanted.insert(missing[i]);
      open[left++] = open[i];
    }
    open.resize(left);
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

const PointCells::Tree* PointCells::View::tree(std::size_t cell) {
  stop_if_cancelled();
  if (const Tree* known = of_.cells_[cell].loaded.get()) return known;
  if (loading_ != nullptr) return &loading_->load(cell, near_);
  missing_ = cell;
  return nullptr;
}

/// From the slab of the place to both sides along the axis, as long as a slab may hold a point that is not farther than
/// the k found; in a slab the nearest cells first.
const std::vector<CellNeighbor>* PointCells::View::nearest(Vec3 place, std::size_t k, double most2) {
  std::vector<CellNeighbor>& found = neighbors_;
  found.clear();
  const std::vector<Slab>& slabs = of_.slabs_;
  const Vec3 p = of_.flat(place);
  const double at = p[of_.axis_];
  const auto worst = [&] { return found.size() == k ? found.back().distance2 : most2; };
  const std::size_t near = slabs.empty() ? 0 : of_.slab_at(at);
  std::size_t before = near, behind = near;  // slabs from `before` to `behind` - 1 have been searched
  while (before > 0 || behind < slabs.size()) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const double up = behind == near ? 0 : behind < slabs.size() ? slabs[behind].box.lo[of_.axis_] - at : kNone;
    const double down = before > 0 ? at - slabs[before - 1].box.hi[of_.axis_] : kNone;
    const bool goes_up = behind == near || up <= down;
    if (behind != near && (goes_up ? up * up : down * down) > worst()) break;
    const Slab& slab = slabs[goes_up ? behind++ : --before];
    const bool complete = slab.cells.nearest_first(p, worst, [&](std::size_t c) {
      const Tree* const points = tree(slab.first_cell + c);
      if (points != nullptr) points->nearest(p, k, most2, found);
      return points != nullptr;
    });
    if (!complete) return nullptr;
  }
  return &found;
}

bool PointCells::View::within(const Box& box, const std::function<void(const CellPoint&)>& use) {
  const std::vector<Slab>& slabs = of_.slabs_;
  for (std::size_t s = slabs.empty() ? 0 : of_.slab_at(box.lo[of_.axis_]); s < slabs.size(); ++s) {
    if (slabs[s].box.lo[of_.axis_] > box.hi[of_.axis_]) break;
    const bool complete = slabs[s].cells.all_within(box, [&](std::size_t c) {
      const Tree* const points = tree(slabs[s].first_cell + c);
      if (points != nullptr) points->within(box, use);
      return points != nullptr;
    });
    if (!complete) return false;
  }
  return true;
}

}  // namespace pointsweep
