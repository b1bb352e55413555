// SPDX-License-Identifier: MIT
#include "pointsweep/operators/plane_strips.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace pointsweep {
namespace {

constexpr std::size_t kStripPoints = 2048;
constexpr std::size_t kLeastLoaded = 8;
/// Strips before and behind those of a batch that are loaded with it.
constexpr std::size_t kLoadedAround = 2;

double squared(double x) { return x * x; }

}  // namespace

bool PlaneNeighbor::operator<(const PlaneNeighbor& other) const {
  const auto key = [](const PlaneNeighbor& n) {
    return std::tuple(n.distance2, n.position.x, n.position.y, n.position.z, n.row);
  };
  return key(*this) < key(other);
}

PlaneStrips::PlaneStrips(int axis, std::uint64_t memory_bytes, std::unique_ptr<Scratch> scratch)
    : axis_(axis),
      most_loaded_(std::max<std::size_t>(kLeastLoaded, static_cast<std::size_t>(memory_bytes / strip_bytes()))),
      scratch_(std::move(scratch)) {}

/// With the node of the map that holds it.
std::uint64_t PlaneStrips::strip_bytes() { return kStripPoints * sizeof(Point) + 128; }

void PlaneStrips::add(Vec3 position, std::uint64_t row) {
  strip_.push_back({position, row});
  if (strip_.size() == kStripPoints) end_strip();
}

void PlaneStrips::finish() {
  if (!strip_.empty()) end_strip();
}

void PlaneStrips::end_strip() {
  strips_.push_back({along(strip_.front().position), along(strip_.back().position), count_, strip_.size()});
  std::ranges::sort(strip_, {}, [this](const Point& p) { return across(p.position); });
  scratch_->append(std::as_bytes(std::span(strip_)));
  count_ += strip_.size();
  strip_.clear();
}

/// The first strip that ends at or behind a place along the axis, or the last one.
std::size_t PlaneStrips::strip_at(double along) const {
  const auto at = std::ranges::lower_bound(strips_, along, {}, &Strip::most);
  return std::min(static_cast<std::size_t>(at - strips_.begin()), strips_.size() - 1);
}

const PlaneStrips::Points* PlaneStrips::loaded(std::size_t strip) const {
  const auto found = loaded_.find(strip);
  return found == loaded_.end() ? nullptr : &found->second;
}

/// Makes room by dropping what is farthest from `near`.
const PlaneStrips::Points& PlaneStrips::loaded_now(std::size_t strip, std::size_t near) {
  if (const Points* known = loaded(strip)) return *known;
  while (loaded_.size() >= most_loaded_) {
    const std::size_t first = loaded_.begin()->first, last = loaded_.rbegin()->first;
    const std::size_t before = near > first ? near - first : 0, behind = last > near ? last - near : 0;
    loaded_.erase(before >= behind ? first : last);
  }
  Points& points = loaded_[strip];
  points.resize(strips_[strip].count);
  scratch_->read(strips_[strip].first * sizeof(Point), std::as_writable_bytes(std::span(points)));
  return points;
}

void PlaneStrips::load(double from, double to) {
  if (strips_.empty()) return;
  const std::size_t first = strip_at(from), last = std::min(strip_at(to) + kLoadedAround, strips_.size() - 1);
  const std::size_t begin = first - std::min(first, kLoadedAround);
  for (std::size_t s = begin; s <= last && s < begin + most_loaded_; ++s) loaded_now(s, first);
}

bool PlaneStrips::find_loaded(Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found) const {
  return search(place, k, found, [this](std::size_t strip, std::size_t) { return loaded(strip); });
}

void PlaneStrips::find(Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found) {
  search(place, k, found, [this](std::size_t strip, std::size_t near) { return &loaded_now(strip, near); });
}

/// From the strip of the place to both sides, as long as a strip may hold a point that is not farther than the k found.
template <class GetStrip>
bool PlaneStrips::search(Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found, GetStrip get_strip) const {
  found.clear();
  if (strips_.empty()) return true;
  const std::size_t near = strip_at(along(place));
  std::size_t before = near, behind = near;  // strips from `before` to `behind` - 1 have been searched
  while (before > 0 || behind < strips_.size()) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const double up = behind == near ? 0 : behind < strips_.size() ? strips_[behind].least - along(place) : kNone;
    const double down = before > 0 ? along(place) - strips_[before - 1].most : kNone;
    const bool goes_up = behind == near || up <= down;
    if (found.size() == k && squared(goes_up ? up : down) > found.back().distance2) return true;
    const Points* points = get_strip(goes_up ? behind++ : --before, near);
    if (points == nullptr) {
      found.clear();
      return false;
    }
    search_strip(*points, place, k, found);
  }
  return true;
}

/// From the place to both sides across the axis.
void PlaneStrips::search_strip(const Points& points, Vec3 place, std::size_t k,
                               std::vector<PlaneNeighbor>& found) const {
  const double own = across(place);
  const auto is_wanted = [&](const Point& p) {
    return found.size() < k || squared(across(p.position) - own) <= found.back().distance2;
  };
  const auto middle = std::ranges::lower_bound(points, own, {}, [this](const Point& p) { return across(p.position); });
  auto up = middle, down = middle;
  bool more = true;
  while (more) {
    more = false;
    if (up != points.end() && is_wanted(*up)) take(*up++, place, k, found), more = true;
    if (down != points.begin() && is_wanted(*(down - 1))) take(*--down, place, k, found), more = true;
  }
}

/// `found` stays in order, of at most k.
void PlaneStrips::take(const Point& point, Vec3 place, std::size_t k, std::vector<PlaneNeighbor>& found) {
  const double distance2 = squared(point.position.x - place.x) + squared(point.position.y - place.y);
  const PlaneNeighbor next{distance2, point.position, point.row};
  if (found.size() == k && !(next < found.back())) return;
  if (found.size() == k) found.pop_back();
  found.insert(std::upper_bound(found.begin(), found.end(), next), next);
}

}  // namespace pointsweep
