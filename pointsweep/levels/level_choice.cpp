// SPDX-License-Identifier: MIT
#include "pointsweep/levels/level_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

constexpr int kDepthBits = 5;
static_assert(kMostDepth < 1 << kDepthBits);
/// A value that means no limit: for the points that a node other than the root keeps, and for the memory if there are
/// no temporary files.
constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

bool is_in(const Box& box, Vec3 p) {
  return box.lo.x <= p.x && p.x <= box.hi.x && box.lo.y <= p.y && p.y <= box.hi.y && box.lo.z <= p.z && p.z <= box.hi.z;
}

Box grown(Box box, double by) {
  const Vec3 all{by, by, by};
  return {box.lo - all, box.hi + all};
}

int parity(const Octant& octant) {
  return static_cast<int>((octant.at[0] & 1) | (octant.at[1] & 1) << 1 | (octant.at[2] & 1) << 2);
}

/// Calls `use` with the octant and all octants of its depth that touch it.
template <class Use>
void for_each_around(const Octant& octant, const Use& use) {
  const std::int64_t side = std::int64_t{1} << octant.depth;
  for (int i = 0; i < 27; ++i) {
    const std::array<std::int64_t, 3> at{octant.at[0] + i % 3 - std::int64_t{1},
                                         octant.at[1] + i / 3 % 3 - std::int64_t{1},
                                         octant.at[2] + i / 9 - std::int64_t{1}};
    if (std::ranges::any_of(at, [&](std::int64_t number) { return number < 0 || number >= side; })) continue;
    use(Octant{
        octant.depth,
        {static_cast<std::uint32_t>(at[0]), static_cast<std::uint32_t>(at[1]), static_cast<std::uint32_t>(at[2])}});
  }
}

/// Bytes that all threads share, and bytes for each thread, which hold the kept points around a node, a stretch of
/// records and its sorted copy.
constexpr std::uint64_t kLeastLevelBytes = 32 << 20, kThreadBytes = 8 << 20;

std::uint64_t memory_of_records(std::uint64_t memory_bytes) { return memory_bytes / 4 * 3; }

}  // namespace

const Leaf* leaf_around(std::span<const Leaf> leaves, const Octant& octant) {
  const auto behind = std::ranges::upper_bound(leaves, first_key(octant), {}, &Leaf::key);
  if (behind == leaves.begin()) return nullptr;
  const Leaf& leaf = *std::prev(behind);
  if (leaf.depth > octant.depth) return nullptr;
  return octant_of(first_key(octant), leaf.depth) == octant_of(leaf.key, leaf.depth) ? &leaf : nullptr;
}

void LeafFinder::add(std::span<const CurveKey> keys) {
  for (const CurveKey& key : keys) {
    if (count_ > 0 && key != last_) {
      const int common = common_depth(last_, key);
      close(common + 1);
      std::fill(first_.begin() + common + 1, first_.end(), count_);
      first_at_last_ = count_;
    }
    last_ = key;
    ++count_;
  }
}

/// Ends the octants of the last point from `depth` down to the finest. The largest octant that need not be divided
/// becomes a leaf, and replaces the leaves within it.
void LeafFinder::close(int depth) {
  for (; depth <= kMostDepth; ++depth) {
    const std::uint64_t first = first_[depth];
    const bool is_leaf = count_ - first <= kMostLeafPoints || first_at_last_ <= first || depth == kMostDepth;
    if (!is_leaf) continue;
    while (!leaves_.empty() && leaves_.back().first >= first) leaves_.pop_back();
    leaves_.push_back({first_key(octant_of(last_, depth)), depth, first, count_ - first});
    return;
  }
}

std::vector<Leaf> LeafFinder::finish() {
  if (count_ > 0) close(0);
  return std::move(leaves_);
}

LevelChoice::LevelChoice(const CurvePoints& points, std::vector<Leaf> leaves, ScratchRoom& room,
                         std::uint64_t memory_bytes)
    : points_(points),
      grid_(points.grid()),
      leaves_(std::move(leaves)),
      room_(room),
      spacing_(grid_.width() / kDiscsAcrossCube),
      borders_(room.make(points.count() / 16 * sizeof(GridPoint))),
      border_(leaves_.size()),
      kept_(room.files(), room.has_files() ? memory_bytes : kAnyNumber, points.count() / 2) {}

void LevelChoice::run() {
  std::optional<Depth> before;
  for (int depth = 0;; ++depth) {
    std::vector<Node> nodes = divided_nodes(depth);
    if (nodes.empty()) break;
    Depth now{depth, std::ldexp(spacing_, -depth), std::move(nodes),
              PointLists(room_.make(2 * taken_ * sizeof(GridPoint)))};
    taken_ = 0;
    list_borders(depth, now.spacing);
    if (depth == 0)
      choose_root(now);
    else
      choose_nodes(now, *before);
    before = std::move(now);
  }
  kept_.finish();
  next_kept_ = kept_.next();
}

std::vector<LevelChoice::Node> LevelChoice::divided_nodes(int depth) const {
  std::vector<Node> nodes;
  for (const Leaf& leaf : leaves_) {
    if (leaf.depth <= depth) continue;
    const CurveKey key = first_key(octant_of(leaf.key, depth));
    if (nodes.empty() || nodes.back().key != key) nodes.push_back({key, {leaf.first, 0}});
    nodes.back().rows.count += leaf.count;
  }
  return nodes;
}

void LevelChoice::choose_root(Depth& root) {
  for (int growth = 0;; ++growth) {
    root.spacing = spacing_ * std::exp2(0.5 * growth);
    const std::optional<Kept> kept = choose_node(root, nullptr, root.nodes[0], kMostRootPoints);
    if (!kept) continue;
    spacing_ = root.spacing;
    return end_node(root, root.nodes[0], *kept);
  }
}

void LevelChoice::choose_nodes(Depth& now, const Depth& before) {
  for (int turn = 0; turn < 8; ++turn) {
    std::vector<Node*> nodes;
    for (Node& node : now.nodes)
      if (parity(octant_of(node.key, now.depth)) == turn) nodes.push_back(&node);
    const std::size_t group = thread_count();
    for (std::size_t first = 0; first < nodes.size(); first += group) {
      std::vector<Kept> kept(std::min(group, nodes.size() - first));
      parallel_for(kept.size(), [&](std::size_t i, unsigned) {
        stop_if_cancelled();
        kept[i] = *choose_node(now, &before, *nodes[first + i], kAnyNumber);
      });
      for (std::size_t i = 0; i < kept.size(); ++i) end_node(now, *nodes[first + i], kept[i]);
    }
  }
}

std::optional<LevelChoice::Kept> LevelChoice::choose_node(const Depth& now, const Depth* before, const Node& node,
                                                          std::size_t most) const {
  const Octant octant = octant_of(node.key, now.depth);
  const Box box = grid_.box(octant), near = grown(box, now.spacing);
  KeptGrid grid(now.spacing, near.lo);
  Kept kept;
  const Box own = grown(box, 1);  // a point on a face may belong to either octant
  for (const GridPoint& point : excluders(now, before, octant, near)) {
    const Vec3 place = grid_.place(point);
    grid.add(place);
    if (is_in(own, place)) kept.all.push_back(point);
  }
  std::optional<std::vector<KeptPoint>> chosen = choose_discs(points_, node.rows, grid, most);
  if (!chosen) return {};
  kept.chosen = std::move(*chosen);
  for (const KeptPoint& point : kept.chosen) kept.all.push_back(point.point);
  return kept;
}

/// Returns the points in the box `near` that were taken before the points of the node. They come from the borders of
/// leaves, from nodes of the same depth that are done, and elsewhere from nodes of the depth before.
std::vector<GridPoint> LevelChoice::excluders(const Depth& now, const Depth* before, const Octant& octant,
                                              const Box& near) const {
  std::vector<const Node*> sources, parents;
  std::vector<const Leaf*> leaves;
  const auto add_once = [](auto& all, auto* one) {
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
  };
  for_each_around(octant, [&](const Octant& beside) {
    if (const Leaf* leaf = leaf_around(leaves_, beside)) return add_once(leaves, leaf);
    const Node* node = find_node(now.nodes, beside);
    if (node == nullptr) return;
    if (node->is_done)
      add_once(sources, node);
    else if (before != nullptr)
      add_once(parents, find_node(before->nodes, parent_of(beside)));
  });
  std::vector<GridPoint> found;
  const auto take = [&](const std::vector<GridPoint>& list) {
    for (const GridPoint& point : list)
      if (is_in(near, grid_.place(point))) found.push_back(point);
  };
  for (const Leaf* leaf : leaves) take(borders_.read(border_[static_cast<std::size_t>(leaf - leaves_.data())]));
  for (const Node* node : sources) take(now.lists.read(node->list));
  for (const Node* node : parents) take(before->lists.read(node->list));
  return found;
}

void LevelChoice::end_node(Depth& now, Node& node, const Kept& kept) {
  for (const KeptPoint& point : kept.chosen) kept_.add(point.row << kDepthBits | static_cast<std::uint64_t>(now.depth));
  node.list = now.lists.add(kept.all);
  node.is_done = true;
  taken_ += kept.all.size();
}

/// Fills border_ for the leaves of depth `depth` with their points that may exclude points outside of the leaf.
void LevelChoice::list_borders(int depth, double spacing) {
  const std::size_t group = thread_count();
  std::vector<std::size_t> of_depth;
  for (std::size_t i = 0; i < leaves_.size(); ++i)
    if (leaves_[i].depth == depth) of_depth.push_back(i);
  for (std::size_t first = 0; first < of_depth.size(); first += group) {
    std::vector<std::vector<GridPoint>> found(std::min(group, of_depth.size() - first));
    parallel_for(found.size(),
                 [&](std::size_t i, unsigned) { found[i] = border_of(leaves_[of_depth[first + i]], spacing); });
    for (std::size_t i = 0; i < found.size(); ++i) border_[of_depth[first + i]] = borders_.add(found[i]);
  }
}

std::vector<GridPoint> LevelChoice::border_of(const Leaf& leaf, double spacing) const {
  const Box inside = grown(grid_.box(octant_of(leaf.key, leaf.depth)), -spacing);
  std::vector<GridPoint> border, some;
  for (std::uint64_t row = leaf.first; row < leaf.end(); row += some.size()) {
    stop_if_cancelled();
    some.resize(static_cast<std::size_t>(std::min(CurvePoints::kBlockRows, leaf.end() - row)));
    points_.read(row, some);
    for (const GridPoint& point : some)
      if (!is_in(inside, grid_.place(point)) && (border.empty() || border.back() != point)) border.push_back(point);
  }
  return border;
}

const LevelChoice::Node* LevelChoice::find_node(const std::vector<Node>& nodes, const Octant& octant) {
  const auto at = std::ranges::lower_bound(nodes, first_key(octant), {}, &Node::key);
  return at != nodes.end() && at->key == first_key(octant) ? &*at : nullptr;
}

int LevelChoice::next_depth() {
  while (next_row_ == leaves_[next_leaf_].end()) ++next_leaf_;
  const std::uint64_t row = next_row_++;
  if (!next_kept_ || *next_kept_ >> kDepthBits != row) return leaves_[next_leaf_].depth;
  const auto depth = static_cast<int>(*next_kept_ & ((1 << kDepthBits) - 1));
  next_kept_ = kept_.next();
  return depth;
}

std::uint64_t least_level_bytes(unsigned threads) { return kLeastLevelBytes + threads * kThreadBytes; }

bool puts_records_aside(std::uint64_t bytes, std::uint64_t memory_bytes) {
  return CurveRecords::puts_aside(bytes, memory_of_records(memory_bytes));
}

LevelledRecords::LevelledRecords(std::size_t record_bytes, std::uint64_t memory_bytes, const MakeScratch& files)
    : record_bytes_(record_bytes),
      memory_(memory_bytes),
      records_(record_bytes, memory_of_records(memory_bytes), files),
      room_(memory_bytes / 8, files) {}

void LevelledRecords::choose(Vec3 scale) {
  grid_.emplace(records_.count() > 0 ? records_.bounds() : GridBounds{}, scale);
  spacing_ = grid_->width() / kDiscsAcrossCube;
  if (records_.count() == 0) return;
  records_.sort(*grid_);
  points_.emplace(*grid_, records_.count(), room_);
  LeafFinder finder;
  records_.for_each([&](std::span<const std::byte> records, std::span<const CurveKey> keys) {
    finder.add(keys);
    points_->add(records, record_bytes_);
  });
  choice_.emplace(*points_, finder.finish(), room_, memory_ / 8);
  choice_->run();
  spacing_ = choice_->spacing();
}

void LevelledRecords::for_each(const Use& use) {
  if (records_.count() == 0) return;
  records_.for_each([&](std::span<const std::byte> records, std::span<const CurveKey> keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) use(keys[i], choice_->next_depth(), &records[i * record_bytes_]);
  });
}

}  // namespace pointsweep
