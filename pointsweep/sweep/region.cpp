// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/region.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/free_memory.h"
#include "pointsweep/order/working_record.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr std::size_t kCollectedAtOnce = 1024;  ///< points that a thread tests at a time

std::span<const NeededPlace> places_of(std::uint32_t slab, std::span<const NeededPlace> places) {
  const auto here = std::ranges::equal_range(places, slab, {}, &NeededPlace::slab);
  return {here.begin(), here.end()};
}

/// Returns an upper bound of distance2() from `p` to any point of the box.
double farthest_distance2(const Box& b, Vec3 p) {
  const double dx = std::max(std::abs(b.lo.x - p.x), std::abs(b.hi.x - p.x));
  const double dy = std::max(std::abs(b.lo.y - p.y), std::abs(b.hi.y - p.y));
  const double dz = std::max(std::abs(b.lo.z - p.z), std::abs(b.hi.z - p.z));
  return (dx * dx + dy * dy) + dz * dz;
}

/// Finds the least distance from a place within which whole cells hold `count` points.
struct WholeCells {
  Vec3 place;
  std::uint64_t count;
  double reach2;  ///< squared distance that holds `count` points; infinite while too few points have been added
  /// For each cell, the squared distance to its farthest corner and the number of its points; ascending.
  std::vector<std::pair<double, std::uint64_t>> cells;

  void add(const std::vector<DroppedCell>& more) {
    for (const DroppedCell& cell : more)
      if (const double d2 = farthest_distance2(cell.box, place); d2 < reach2) cells.emplace_back(d2, cell.points);
    std::ranges::sort(cells);
    std::uint64_t points = 0;
    const auto last = std::ranges::find_if(cells, [&](const auto& cell) { return (points += cell.second) >= count; });
    if (last == cells.end()) return;
    reach2 = last->first;
    cells.erase(std::next(last), cells.end());
  }
};

}  // namespace

PointCollector::PointCollector(const Stream& stream, const Frontier& frontier, WantedPoints wanted)
    : stream_(stream),
      frontier_(frontier),
      wanted_(std::move(wanted)),
      position_(position_fields(stream.record_schema(), "the working record")),
      reach2_(std::make_unique<std::atomic<double>[]>(wanted_.balls.size())),
      distances2_(wanted_.balls.size()),
      cover_(wanted_.whole_balls) {
  for (std::size_t n = 0; n < wanted_.balls.size(); ++n) reach2_[n] = wanted_.balls[n].reach2;
}

bool PointCollector::run(std::size_t slabs_at_once) {
  const std::vector<std::uint32_t> slabs = touched_slabs();
  const std::size_t stride = stream_.record_schema().stride;
  Prefetch<CollectedPoints> searched(
      [&](std::size_t i) {
        std::vector<std::byte> records(stream_.slabs()[slabs[i]].count * stride);
        stream_.read(slabs[i], records);
        return search(slabs[i], records);
      },
      0, slabs.size(), slabs_at_once);
  for (const std::uint32_t slab : slabs) {
    CollectedPoints found = searched.next();
    slabs_read_.add({1, stream_.slabs()[slab].count * stride});
    points_ += found.index_in_slab.size();
    if (!found.index_in_slab.empty()) found_.push_back(std::move(found));
    if (points_ > wanted_.most_points) drop_points_outside();
    if (points_ > wanted_.most_points) return false;
  }
  drop_points_outside();
  return true;
}

std::vector<std::uint32_t> PointCollector::touched_slabs() const {
  std::vector<std::uint8_t> is_touched(stream_.slabs().size());
  parallel_for(is_touched.size(), [&](std::size_t s, unsigned) {
    stop_if_cancelled();
    const auto slab = static_cast<std::uint32_t>(s);
    is_touched[s] = is_needed(slab);
  });
  std::vector<std::uint32_t> slabs;
  for (std::uint32_t slab = 0; slab < is_touched.size(); ++slab)
    if (is_touched[slab]) slabs.push_back(slab);
  return slabs;
}

/// Returns whether the ball touches a cell of the slab that holds a point that is not superfluous.
bool PointCollector::touches(const Ball& ball, std::uint32_t slab) const {
  return distance2(stream_.slabs()[slab].box, ball.center) <= ball.reach2 &&
         std::ranges::any_of(frontier_.dropped_of(slab),
                             [&](const DroppedCell& cell) { return distance2(cell.box, ball.center) <= ball.reach2; });
}

bool PointCollector::is_needed(std::uint32_t slab) const {
  const auto touches_slab = [&](const Ball& ball) { return touches(ball, slab); };
  return !places_of(slab, wanted_.places).empty() || std::ranges::any_of(wanted_.balls, touches_slab) ||
         std::ranges::any_of(wanted_.whole_balls, touches_slab);
}

/// Records a point inside a ball. Once the ball has as many points as are wanted, it shrinks to the farthest of the
/// nearest points.
void PointCollector::shrink(std::uint32_t ball, double d2) {
  const std::scoped_lock lock(mutexes_[ball % mutexes_.size()]);
  std::vector<double>& nearest = distances2_[ball];
  if (nearest.size() == wanted_.nearest) {
    if (d2 >= nearest.front()) return;
    std::ranges::pop_heap(nearest);
    nearest.pop_back();
  }
  nearest.reserve(wanted_.nearest);
  nearest.push_back(d2);
  std::ranges::push_heap(nearest);
  if (nearest.size() == wanted_.nearest && nearest.front() < reach2_of(ball)) reach2_[ball] = nearest.front();
}

bool PointCollector::is_superfluous(Vec3 p, const std::byte* record) const {
  return frontier_.is_superfluous({p, p}, row_of(stream_.record_schema(), record));
}

/// Returns the numbers of the records for which is_inside(point, record) is true, ascending.
template <class IsInside>
std::vector<std::uint32_t> PointCollector::numbers_of(std::span<const std::byte> records,
                                                      const IsInside& is_inside) const {
  const std::size_t stride = stream_.record_schema().stride, count = records.size() / stride;
  std::vector<std::vector<std::uint32_t>> inside((count + kCollectedAtOnce - 1) / kCollectedAtOnce);
  parallel_for(inside.size(), [&](std::size_t part, unsigned) {
    stop_if_cancelled();
    std::array<double, kCollectedAtOnce> x, y, z;
    const std::size_t first = part * kCollectedAtOnce, size = std::min(kCollectedAtOnce, count - first);
    const std::byte* const begin = records.data() + first * stride;
    decode_positions(position_, begin, stride, size, x.data(), y.data(), z.data());
    for (std::size_t i = 0; i < size; ++i)
      if (is_inside(Vec3{x[i], y[i], z[i]}, begin + i * stride))
        inside[part].push_back(static_cast<std::uint32_t>(first + i));
  });
  std::vector<std::uint32_t> numbers;
  for (const auto& part : inside) numbers.insert(numbers.end(), part.begin(), part.end());
  return numbers;
}

/// Returns the numbers of the records whose points lie inside a ball of `balls`, or inside or near a ball of
/// `whole_balls`, ascending and without superfluous points. `shrinks`: true if the records are searched for the first
/// time, so that the balls of `balls` shrink.
std::vector<std::uint32_t> PointCollector::numbers_inside(std::uint32_t slab, std::span<const std::byte> records,
                                                          bool shrinks) {
  std::vector<std::uint32_t> numbers;
  std::vector<Ball> balls;
  for (std::uint32_t n = 0; n < wanted_.balls.size(); ++n) {
    if (!touches(ball_now(n), slab)) continue;
    numbers.push_back(n);
    balls.push_back(ball_now(n));
  }
  const BallLookup index(balls);
  const BallRaster raster(stream_.slabs()[slab].box, balls);
  return numbers_of(records, [&](Vec3 p, const std::byte* record) {
    bool is_inside = cover_.covers(p);
    if (is_inside && is_superfluous(p, record)) return false;
    if (!raster.may_hold(p)) return is_inside;
    index.for_each_near(p, [&](std::uint32_t near) {
      const double d2 = distance2(balls[near].center, p);
      if (d2 > reach2_of(numbers[near])) return;
      is_inside = is_inside || !is_superfluous(p, record);
      if (is_inside && shrinks) shrink(numbers[near], d2);
    });
    return is_inside;
  });
}

CollectedPoints PointCollector::search(std::uint32_t slab, std::span<const std::byte> records) {
  CollectedPoints found{slab, {}, {}};
  const std::vector<std::uint32_t> inside = numbers_inside(slab, records, true);
  std::vector<std::uint32_t> places;
  for (const NeededPlace& place : places_of(slab, wanted_.places)) places.push_back(place.index_in_slab);
  std::ranges::set_union(inside, places, std::back_inserter(found.index_in_slab));
  const std::size_t stride = stream_.record_schema().stride;
  found.records.resize(found.index_in_slab.size() * stride);
  for (std::size_t i = 0; i < found.index_in_slab.size(); ++i)
    std::memcpy(found.records.data() + i * stride, records.data() + found.index_in_slab[i] * stride, stride);
  return found;
}

/// Drops collected points that now lie outside all balls, because balls have shrunk since. Points of `places` stay.
void PointCollector::drop_points_outside() {
  if (wanted_.balls.empty()) return;
  points_ = 0;
  for (CollectedPoints& found : found_) {
    const std::vector<std::uint32_t> inside = numbers_inside(found.slab, found.records, false);
    const std::span<const NeededPlace> places = places_of(found.slab, wanted_.places);
    found.keep_only([&](std::uint32_t i) {
      return std::ranges::binary_search(inside, i) ||
             std::ranges::binary_search(places, found.index_in_slab[i], {}, &NeededPlace::index_in_slab);
    });
    found.records.shrink_to_fit();
    points_ += found.index_in_slab.size();
  }
}

bool Region::collect(WantedPoints wanted) {
  PointCollector collector(stream_, frontier_, std::move(wanted));
  const bool fits = collector.run(slabs_at_once_);
  slabs_read_.add(collector.slabs_read());
  if (!fits) return false;
  std::vector<CollectedPoints> found = collector.take();
  std::vector<std::vector<std::unique_ptr<WindowCell>>> cells(found.size());
  parallel_for(found.size(), [&](std::size_t i, unsigned) {
    const std::vector<std::uint32_t>& held = held_[found[i].slab];
    found[i].keep_only([&](std::uint32_t n) { return !std::ranges::binary_search(held, found[i].index_in_slab[n]); });
    cells[i] = loader_.cells_of(found[i].slab, found[i].index_in_slab, found[i].records);
    free_memory_of(found[i].records);
  });
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (auto& cell : cells[i]) add(std::move(cell));
    std::vector<std::uint32_t>& held = held_[found[i].slab];
    const auto middle = held.insert(held.end(), found[i].index_in_slab.begin(), found[i].index_in_slab.end());
    std::inplace_merge(held.begin(), middle, held.end());
  }
  return true;
}

bool Region::touches_more_than(std::uint64_t count, Vec3 p, double reach2) const {
  std::uint64_t points = 0;
  for (std::uint32_t slab = 0; slab < held_.size(); ++slab) {
    if (distance2(stream_.slabs()[slab].box, p) > reach2) continue;
    for (const DroppedCell& cell : frontier_.dropped_of(slab))
      if (distance2(cell.box, p) <= reach2 && (points += cell.points) > count) return true;
  }
  return false;
}

/// Searches the nearest slab first, since the distance found there excludes most other slabs.
double Region::reach2_that_holds(Vec3 p, std::uint64_t count) const {
  const std::vector<Slab>& slabs = stream_.slabs();
  WholeCells found{p, count, Box::kInf, {}};
  const auto nearest = std::ranges::min_element(slabs, {}, [&](const Slab& slab) { return distance2(slab.box, p); });
  const auto first = static_cast<std::uint32_t>(nearest - slabs.begin());
  found.add(frontier_.dropped_of(first));
  std::vector<std::pair<double, std::uint32_t>> others;  // squared distance and number of a slab
  for (std::uint32_t slab = 0; slab < slabs.size(); ++slab)
    if (const double d2 = distance2(slabs[slab].box, p); slab != first && d2 <= found.reach2)
      others.emplace_back(d2, slab);
  std::ranges::sort(others);
  for (const auto& [d2, slab] : others) {
    if (d2 > found.reach2) break;
    found.add(frontier_.dropped_of(slab));
  }
  return found.reach2;
}

}  // namespace pointsweep
