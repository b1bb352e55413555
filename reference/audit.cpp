// SPDX-License-Identifier: MIT
#include "reference/audit.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace pointsweep::reference {
namespace {

bool same(const Rank& a, const Rank& b) { return a.row == b.row; }

/// Returns whether no point that had been written can be within `reach2`.
bool nothing_written_within(double reach2, const StreamPoint& point) {
  return point.written == 0 || reach2 < point.written2;
}

}  // namespace

void Audit::arrived(StreamPoint& point) {
  NearestSet nearest({.k = reach_.k, .radius2 = point.neighbors.reach2()});
  hidden_.find_nearest(point.input, nearest);
  nearest.sort();
  point.hidden = ranks_of(nearest.found());
  point.written = written_;
  const double behind = point.input[sweep_axis_] - written_to_;
  point.written2 = behind * behind;
}

void Audit::completed(StreamPoint& point) {
  hidden_.insert(point);
  if (point.hidden.empty() && nothing_written_within(point.neighbors.reach2(), point)) {
    ++complete_;
    return;
  }
  Suspect found = suspect(point);
  if (nothing_written_within(found.exact.reach2(), point)) return judge(found);
  suspects_.add(std::move(found));
  if (suspects_.full()) settle();
}

Suspect Audit::suspect(StreamPoint& point) const {
  const std::vector<Rank> found = ranks_of(point.neighbors.found()), hidden = std::exchange(point.hidden, {});
  std::vector<Rank> known;
  std::merge(found.begin(), found.end(), hidden.begin(), hidden.end(), std::back_inserter(known));
  return {.point = shortening_.ruled(point),
          .kept = ranks_of(point.neighbors.kept()),
          .exact = {reach_, std::move(known)},
          .written = point.written};
}

void Audit::settle() {
  for (const Suspect& suspect : suspects_.settled()) judge(suspect);
}

void Audit::judge(const Suspect& suspect) {
  const std::size_t count = shortening_.kept(suspect.point, suspect.exact.ranks());
  const auto exact = suspect.exact.ranks().first(count);
  const bool equal = std::equal(suspect.kept.begin(), suspect.kept.end(), exact.begin(), exact.end(), same);
  ++(equal ? complete_ : incomplete_);
}

void Audit::written(const StreamPoint& point) {
  assert(&hidden_.smallest() == &point);
  hidden_.pop_smallest();
  written_to_ = point.input[sweep_axis_];
  ++written_;
}

}  // namespace pointsweep::reference
