// SPDX-License-Identifier: MIT
#include "pointsweep/connect/spanning_forest.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace pointsweep {

SpanningForest::SpanningForest(bool weighted, const VoteRule* votes, ForestLog& log)
    : weighted_(weighted),
      rule_(votes),
      vote_bytes_(votes != nullptr ? votes->bytes() : 0),
      result_(votes != nullptr ? votes->result_bytes() : 0),
      log_(log) {}

std::uint32_t SpanningForest::new_slot() {
  if (free_.empty()) {
    supernodes_.emplace_back();
    if (supernodes_.size() > kPageSlots * votes_.size()) votes_.emplace_back(kPageSlots * vote_bytes_);
    return static_cast<std::uint32_t>(supernodes_.size() - 1);
  }
  const std::uint32_t slot = free_.back();
  free_.pop_back();
  return slot;
}

void SpanningForest::open(std::span<const PointKey> points, std::span<const std::byte> ballots,
                          std::vector<std::uint64_t>& opened) {
  const std::size_t ballot_bytes = rule_ != nullptr ? rule_->ballot_bytes() : 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [point, is_new] = open_.add(points[i].row);
    if (!is_new) continue;
    const std::uint32_t slot = new_slot();
    *point = {slot, false};
    supernodes_[slot] = {points[i].row, {points[i], 1}, 1, slot, false};
    if (rule_ != nullptr) rule_->start(votes_of(slot), points[i], ballots.data() + i * ballot_bytes);
    live_.push_back(slot);
    opened.push_back(points[i].row);
  }
}

SpanningForest::Root SpanningForest::root_of(std::uint32_t slot) {
  std::uint32_t root = slot;
  bool flips = false;
  for (; supernodes_[root].parent != root; root = supernodes_[root].parent) flips ^= supernodes_[root].flips;
  for (bool rest = flips; slot != root;) {
    Supernode& s = supernodes_[slot];
    const bool own = s.flips;
    slot = std::exchange(s.parent, root);
    s.flips = rest;
    rest ^= own;
  }
  return {root, flips};
}

/// Merges two supernodes. The supernode with fewer points becomes part of the other one, so that paths stay short.
void SpanningForest::merge(Root a, Root b, bool flips) {
  if (supernodes_[a.slot].sums.points < supernodes_[b.slot].sums.points) std::swap(a, b);
  Supernode &to = supernodes_[a.slot], &from = supernodes_[b.slot];
  const bool differs = flips ^ a.flips ^ b.flips;
  from.parent = a.slot;
  from.flips = differs;
  to.open += from.open;
  to.sums.points += from.sums.points;
  to.sums.first = std::min(to.sums.first, from.sums.first);
  if (rule_ != nullptr) rule_->merge(votes_of(a.slot), votes_of(b.slot), differs);
  log_.merged(from.row, b.slot, a.slot, differs);
}

/// Adds edges to the candidates and reduces the candidates by Kruskal's algorithm. Without weights, an edge joins its
/// ends at once, because any spanning forest will do.
void SpanningForest::join(std::span<const ForestEdge> edges) {
  const std::size_t before = candidates_.size();
  for (const ForestEdge& edge : edges) {
    const OpenPoint *a = open_.find(edge.a.row), *b = open_.find(edge.b.row);
    assert(a != nullptr && b != nullptr);
    if (!weighted_) {
      const Root to_a = root_of(a->slot), to_b = root_of(b->slot);
      if (to_a.slot != to_b.slot) merge(to_a, to_b, false);
    } else if (a->slot != b->slot) {
      candidates_.push_back({edge, a->slot, b->slot, edge.flips != (a->flips != b->flips)});
    }
  }
  take_candidates(before);
}

/// Sorts the candidates, and drops each candidate that is the largest edge of a cycle. The first `before` candidates
/// are already sorted and free of cycles.
void SpanningForest::take_candidates(std::size_t before) {
  if (candidates_.size() == before) return;
  const auto less = [](const Candidate& a, const Candidate& b) { return a.edge < b.edge; };
  const auto middle = candidates_.begin() + static_cast<std::ptrdiff_t>(before);
  std::sort(middle, candidates_.end(), less);
  std::inplace_merge(candidates_.begin(), middle, candidates_.end(), less);
  joined_.resize(supernodes_.size());
  for (const std::uint32_t slot : live_) joined_[slot] = slot;
  std::erase_if(candidates_, [this](const Candidate& c) {
    const std::uint32_t a = set_of(joined_, c.a), b = set_of(joined_, c.b);
    joined_[a] = b;
    return a == b;
  });
}

void SpanningForest::close(std::span<const std::uint64_t> rows) {
  for (const std::uint64_t row : rows) {
    const OpenPoint* point = open_.find(row);
    assert(point != nullptr);
    --supernodes_[root_of(point->slot).slot].open;
    open_.erase(row);
  }
  contract();
  let_go();
}

OpenForest SpanningForest::leave() {
  close({});
  OpenForest left;
  std::vector<std::uint32_t> number(supernodes_.size());
  std::ranges::fill(result_, std::byte{0});
  for (const std::uint32_t slot : live_) {
    const Supernode& s = supernodes_[slot];
    number[slot] = static_cast<std::uint32_t>(left.supernodes.size());
    left.supernodes.push_back(s.sums);
    const std::span<const std::byte> votes = std::as_const(*this).votes_of(slot);
    left.votes.insert(left.votes.end(), votes.begin(), votes.end());
    log_.finished(s.row, slot, s.sums, result_.data());
  }
  open_.for_each([&](std::uint64_t row, const OpenPoint& point) {
    left.points.push_back({row, number[point.slot], point.flips});
  });
  for (const Candidate& c : candidates_) left.candidates.push_back({c.edge, number[c.a], number[c.b], c.flips});
  return left;
}

void SpanningForest::adopt(const OpenForest& left, std::uint64_t first) {
  std::vector<std::uint32_t> slots;
  for (std::size_t i = 0; i < left.supernodes.size(); ++i) {
    const std::uint32_t slot = new_slot();
    supernodes_[slot] = {first + i, left.supernodes[i], 0, slot, false};
    std::copy_n(left.votes.data() + i * vote_bytes_, vote_bytes_, votes_of(slot));
    live_.push_back(slot);
    slots.push_back(slot);
  }
  for (const OpenForest::Point& point : left.points) {
    *open_.add(point.row).first = {slots[point.supernode], point.flips};
    ++supernodes_[slots[point.supernode]].open;
  }
  const std::size_t before = candidates_.size();
  for (const Candidate& c : left.candidates) candidates_.push_back({c.edge, slots[c.a], slots[c.b], c.flips});
  take_candidates(before);
}

/// Goes through the candidates from the least to the largest, and merges the two ends of a candidate unless both have
/// open points. The merged candidate is the least candidate of its end without open points (cut property): the loop
/// would have kept a lesser candidate of that end only if both ends of the lesser candidate had open points, and merges
/// close no points.
void SpanningForest::contract() {
  std::erase_if(candidates_, [this](const Candidate& c) {
    const Root a = root_of(c.a), b = root_of(c.b);
    if (supernodes_[a.slot].open > 0 && supernodes_[b.slot].open > 0) return false;
    merge(a, b, c.flips);
    return true;
  });
}

/// Moves candidates and open points to the supernodes that hold them after the merges. Logs the complete supernodes.
/// Frees the slots of the complete and of the merged supernodes.
void SpanningForest::let_go() {
  for (Candidate& c : candidates_) {
    const Root a = root_of(c.a), b = root_of(c.b);
    c.a = a.slot, c.b = b.slot;
    c.flips ^= a.flips != b.flips;
  }
  open_.for_each([this](std::uint64_t, OpenPoint& point) {
    const Root root = root_of(point.slot);
    point = {root.slot, point.flips != root.flips};
  });
  std::erase_if(live_, [this](std::uint32_t slot) {
    const Supernode& s = supernodes_[slot];
    if (s.parent == slot && s.open > 0) return false;
    if (s.parent == slot) {
      if (rule_ != nullptr) rule_->conclude(votes_of(slot), result_.data());
      log_.finished(s.row, slot, s.sums, result_.data());
    }
    free_.push_back(slot);
    return true;
  });
}

}  // namespace pointsweep
