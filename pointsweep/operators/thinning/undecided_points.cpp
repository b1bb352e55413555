// SPDX-License-Identifier: MIT
#include "pointsweep/operators/thinning/undecided_points.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {

bool DiskPoint::operator<(const DiskPoint& other) const {
  const auto key = [](const DiskPoint& p) {
    return std::tuple(p.hash, p.position.x, p.position.y, p.position.z, p.row);
  };
  return key(*this) < key(other);
}

std::size_t UndecidedPoints::CellHash::operator()(const CellKey& key) const {
  std::uint64_t hash = 0;
  for (const std::int64_t k : key) hash = mix(hash ^ static_cast<std::uint64_t>(k));
  return hash;
}

/// A cell is slightly longer than the radius, so coordinates within the radius of a point lie in three adjacent cells.
UndecidedPoints::UndecidedPoints(int axis, double largest_radius, std::uint64_t most)
    : axis_(axis),
      radius_(largest_radius),
      cell_(std::max(largest_radius * (1 + 0x1p-20), std::numeric_limits<double>::min())),
      most_(std::min<std::uint64_t>(most, kNone)),
      front_(-std::numeric_limits<double>::infinity()) {}

/// Returns the number of the cell of coordinate c; monotonic in c.
std::int64_t UndecidedPoints::cell_along(double c) const {
  return static_cast<std::int64_t>(std::clamp(std::floor(c / cell_), -0x1p62, 0x1p62));
}

/// Visits all cells that may contain a point whose rounded distance2() from p is within the largest radius. Such a
/// point has coordinates between c - cell_ and c + cell_ of each coordinate c of p, whatever is rounded, and
/// cell_along() is monotonic. The cell of p comes first. Ends when `visit` returns true.
template <class Visit>
void UndecidedPoints::visit_cells_around(Vec3 p, Visit visit) {
  const CellKey own = {cell_along(p.x), cell_along(p.y), cell_along(p.z)};
  const auto ends_at = [&](const CellKey& key) {
    const auto cell = cells_.find(key);
    if (cell == cells_.end()) return false;
    const bool ends = visit(cell->second);
    if (cell->second.members.empty()) cells_.erase(cell);
    return ends;
  };
  if (ends_at(own)) return;
  CellKey low, high;
  for (int a = 0; a < 3; ++a) {
    low[a] = cell_along(p[a] - cell_);
    high[a] = cell_along(p[a] + cell_);
  }
  for (std::int64_t x = low[0]; x <= high[0]; ++x)
    for (std::int64_t y = low[1]; y <= high[1]; ++y)
      for (std::int64_t z = low[2]; z <= high[2]; ++z)
        if (const CellKey key = {x, y, z}; key != own && ends_at(key)) return;
}

bool UndecidedPoints::precedes(const Member& a, const Member& b) const {
  if (a.hash != b.hash) return a.hash < b.hash;
  return slots_[a.slot].point < slots_[b.slot].point;
}

void UndecidedPoints::sort(Cell& cell) const {
  if (cell.sorted == cell.members.size()) return;
  const auto order = [&](const Member& a, const Member& b) { return precedes(a, b); };
  const auto middle = cell.members.begin() + static_cast<std::ptrdiff_t>(cell.sorted);
  std::sort(middle, cell.members.end(), order);
  std::inplace_merge(cell.members.begin(), middle, cell.members.end(), order);
  cell.sorted = cell.members.size();
}

/// Assigns a slot and a place in its cell to a point.
UndecidedPoints::Slot UndecidedPoints::place(const DiskPoint& point) {
  if (held() >= most_)
    fail(
        "poisson: more than {} points lie within its radius {} behind the front, and memory holds no more: give more "
        "--memory or a smaller radius, or thin with voxel before it.",
        most_, radius_);
  Slot slot = static_cast<Slot>(slots_.size());
  if (free_.empty()) {
    slots_.emplace_back();
  } else {
    slot = free_.back();
    free_.pop_back();
  }
  slots_[slot] = {.point = point, .uses = 2};  // uses: its cell, and the list of its state
  const Vec3 p = point.position;
  cells_[{cell_along(p.x), cell_along(p.y), cell_along(p.z)}].members.push_back({point.hash, slot});
  return slot;
}

void UndecidedPoints::hold(const DiskPoint& point, bool lacks_some) {
  incomplete_.push_back(place(point));
  slots_[incomplete_.back()].lacks_some = lacks_some;
  front_ = point.position[axis_];
  ++come_;
}

/// Cells are sorted again each time, so the function waits until a share of the points is new.
void UndecidedPoints::decide(Findings& findings) {
  constexpr std::uint64_t kShare = 16, kLeast = 256;
  if (come_ < std::max(held() / kShare, kLeast)) return;
  come_ = 0;
  take_complete(front_);
  decide_waiting(findings);
}

void UndecidedPoints::finish(Findings& findings) {
  take_complete(std::numeric_limits<double>::infinity());
  decide_waiting(findings);
  assert(held() == 0);
}

/// The squared distance along the axis, rounded like distance2(), is at most the distance2() to any later point.
void UndecidedPoints::take_complete(double front) {
  for (; !incomplete_.empty(); incomplete_.pop_front()) {
    const Slot slot = incomplete_.front();
    const double ahead = front - slots_[slot].point.position[axis_];
    if (std::isfinite(front) && !(ahead * ahead > radius_ * radius_)) return;
    slots_[slot].is_decided ? release(slot) : to_decide_.push_back(slot);
  }
}

void UndecidedPoints::decide_waiting(Findings& findings) {
  while (!to_decide_.empty()) {
    stop_if_cancelled();
    const Slot slot = to_decide_.back();
    to_decide_.pop_back();
    Held& held = slots_[slot];
    const Slot lesser = held.is_decided ? kNone : lesser_within(held.point);
    if (lesser != kNone) {
      held.next_waiter = slots_[lesser].first_waiter;
      slots_[lesser].first_waiter = slot;
      continue;
    }
    if (!held.is_decided) held.lacks_some ? leave_open(slot, findings) : keep(slot, findings);
    release(slot);
  }
}

/// Returns an undecided point that must be decided before `point`; kNone if there is none.
UndecidedPoints::Slot UndecidedPoints::lesser_within(const DiskPoint& point) {
  Slot found = kNone;
  visit_cells_around(point.position, [&](Cell& cell) {
    sort(cell);
    for (const Member& m : cell.members) {
      if (m.hash > point.hash) return false;
      const Held& other = slots_[m.slot];
      if (other.is_decided || !(other.point < point)) continue;
      if (distance2(other.point.position, point.position) > point.radius2) continue;
      found = m.slot;
      return true;
    }
    return false;
  });
  return found;
}

/// Marks a point as decided, and calls `use` for each undecided greater point that has this point within its own
/// radius. `use` returns whether it has decided that point.
template <class Use>
void UndecidedPoints::decide_for_greater(Slot slot, Use use) {
  const DiskPoint& decided = slots_[slot].point;
  slots_[slot].is_decided = true;
  visit_cells_around(decided.position, [&](Cell& cell) {
    for (const Member& m : cell.members) {
      const Held& other = slots_[m.slot];
      if (m.slot == slot) ++cell.decided;
      if (other.is_decided || !(decided < other.point)) continue;
      if (distance2(other.point.position, decided.position) > other.point.radius2) continue;
      if (use(m.slot)) ++cell.decided;
    }
    forget_decided(cell);
    return false;
  });
}

void UndecidedPoints::keep(Slot slot, Findings& findings) {
  decide_for_greater(slot, [&](Slot greater) {
    leave_out(greater, findings);
    return true;
  });
  // Points that wait for the kept point have it within their radius, so they have just been dropped.
  for (Slot waiter = slots_[slot].first_waiter; waiter != kNone;) {
    const Slot next = slots_[waiter].next_waiter;
    assert(slots_[waiter].is_decided);
    release(waiter);
    waiter = next;
  }
}

void UndecidedPoints::leave_out(Slot slot, Findings& findings) {
  slots_[slot].is_decided = true;
  findings.dropped.push_back(slots_[slot].point.row);
  let_waiters_decide(slot);
}

void UndecidedPoints::leave_open(Slot slot, Findings& findings) {
  findings.undecided.push_back(slots_[slot].point.row);
  decide_for_greater(slot, [&](Slot greater) {
    slots_[greater].lacks_some = true;
    return false;
  });
  let_waiters_decide(slot);
}

void UndecidedPoints::let_waiters_decide(Slot slot) {
  for (Slot waiter = slots_[slot].first_waiter; waiter != kNone; waiter = slots_[waiter].next_waiter)
    to_decide_.push_back(waiter);
  slots_[slot].first_waiter = kNone;
}

void UndecidedPoints::forget_decided(Cell& cell) {
  if (2 * cell.decided <= cell.members.size()) return;
  std::size_t left = 0, sorted = 0;
  for (std::size_t i = 0; i < cell.members.size(); ++i) {
    const Member m = cell.members[i];
    if (slots_[m.slot].is_decided) {
      release(m.slot);
      continue;
    }
    sorted += i < cell.sorted;
    cell.members[left++] = m;
  }
  cell.members.resize(left);
  if (4 * left < cell.members.capacity()) cell.members.shrink_to_fit();
  cell.sorted = sorted;
  cell.decided = 0;
}

void UndecidedPoints::release(Slot slot) {
  if (--slots_[slot].uses == 0) free_.push_back(slot);
}

}  // namespace pointsweep
