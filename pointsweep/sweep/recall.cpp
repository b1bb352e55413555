// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/recall.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

#include "pointsweep/cancellation.h"
#include "pointsweep/sweep/shorten.h"
#include "pointsweep/sweep/stream_search.h"

namespace pointsweep {

namespace {

/// The points a recall evaluates, as structure of arrays: the deferred ones and everything their values rest on.
class Nodes {
 public:
  explicit Nodes(const SweepPlan& plan) : plan_(plan), columns_(plan.column_bytes.size()) {}

  std::size_t size() const { return row_.size(); }
  /// The node of a row, made if it is new; its values are needed through step `step` (-1: only what the file gives).
  std::uint32_t add(Vec3 position, std::uint64_t row, const std::string& file_columns, int step) {
    const auto [it, is_new] = by_row_.try_emplace(row, static_cast<std::uint32_t>(row_.size()));
    if (is_new) {
      x_.push_back(position.x), y_.push_back(position.y), z_.push_back(position.z), row_.push_back(row);
      step_.push_back(step), count_from_.push_back(~0u), lists_.emplace_back();
      for (std::size_t c = 0; c < columns_.size(); ++c) columns_[c].resize(row_.size() * plan_.column_bytes[c]);
      set_file_columns(it->second, file_columns);
    }
    step_[it->second] = std::max(step_[it->second], step);
    return it->second;
  }
  void set_file_columns(std::uint32_t node, const std::string& bytes) {
    std::size_t at = 0;
    for (const FileColumn& file : plan_.file_columns) {
      const std::size_t n = plan_.column_bytes[file.column];
      if (bytes.size() >= at + n) std::memcpy(columns_[file.column].data() + node * n, bytes.data() + at, n);
      at += n;
    }
  }
  /// What the point takes from step `step` on is a result of its own: degenerate cases count.
  void count_from(std::uint32_t node, std::uint32_t step) { count_from_[node] = step; }
  std::vector<std::uint32_t>& list(std::uint32_t node) { return lists_[node]; }
  StreamQuery query(std::uint32_t node, double reach2) const {
    StreamQuery q;
    q.position = {x_[node], y_[node], z_[node]}, q.row = row_[node], q.reach2 = reach2;
    return q;
  }

  /// Runs a step on every node that is needed through it.
  void run(std::size_t step, StageTally& tally) {
    std::vector<const std::byte*> pointers;
    std::vector<PointColumns> slots = views(pointers);
    for (std::uint32_t first = 0; first < size(); first += kCellCapacity) {
      const auto end = std::min<std::uint32_t>(first + kCellCapacity, static_cast<std::uint32_t>(size()));
      for (std::uint32_t i = first; i < end; ++i) {
        stop_if_cancelled();
        if (step_[i] >= static_cast<int>(step)) run_one(step, i, slots, tally);
      }
    }
  }

  void results(std::uint32_t node, std::vector<std::byte>& out) const {
    std::vector<const std::byte*> at;
    for (std::size_t c = 0; c < columns_.size(); ++c) at.push_back(columns_[c].data() + node * plan_.column_bytes[c]);
    collect_results(plan_, at.data(), 1, out);
  }

 private:
  /// Nodes in groups of a cell's capacity, so that neighbour references name them like cells.
  std::vector<PointColumns> views(std::vector<const std::byte*>& pointers) const {
    const std::size_t slots = (size() + kCellCapacity - 1) / kCellCapacity, columns = columns_.size();
    pointers.resize(slots * columns);
    std::vector<PointColumns> views;
    for (std::size_t s = 0; s < slots; ++s) {
      const std::size_t first = s * kCellCapacity;
      for (std::size_t c = 0; c < columns; ++c) {
        pointers[s * columns + c] = columns_[c].data() + first * plan_.column_bytes[c];
      }
      views.push_back({x_.data() + first, y_.data() + first, z_.data() + first, row_.data() + first,
                       pointers.data() + s * columns});
    }
    return views;
  }

  void run_one(std::size_t step, std::uint32_t node, const std::vector<PointColumns>& slots, StageTally& tally) {
    std::vector<NeighborRef> refs;
    for (const std::uint32_t other : lists_[node])
      refs.push_back(make_ref(other / kCellCapacity, other % kCellCapacity));
    const std::uint32_t begin[2] = {0, static_cast<std::uint32_t>(refs.size())};
    std::vector<const std::byte*> own;
    std::vector<std::byte*> made;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      made.push_back(columns_[c].data() + node * plan_.column_bytes[c]);
      own.push_back(made.back());
    }
    const Batch batch{
        {&x_[node], &y_[node], &z_[node], &row_[node], own.data()}, 1, slots.data(), begin, refs.data(), made.data()};
    StageTally ignored;
    StageTally& counted = step >= count_from_[node] ? tally : ignored;
    run_step(plan_, step, batch, counted);
    for_each_marked(plan_, step, counted,
                    [&](std::size_t stage, std::size_t) { counted.degenerate[stage].add(row_[node]); });
  }

  const SweepPlan& plan_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
  std::vector<int> step_;
  std::vector<std::uint32_t> count_from_;
  std::vector<std::vector<std::uint32_t>> lists_;
  std::vector<std::vector<std::byte>> columns_;
  std::unordered_map<std::uint64_t, std::uint32_t> by_row_;
};

}  // namespace

std::size_t Recall::batch_points(std::size_t bytes) const {
  double nodes = 1;
  const double k = static_cast<double>(std::min<std::size_t>(plan_.neighborhood.k, 100'000));
  for (std::size_t s = 0; s < plan_.step_count(); ++s) nodes *= k + 1;
  return std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(bytes) / (nodes * 200)));
}

void Recall::run(std::vector<DeferredPoint> points, Sink& sink, StageTally& tally) {
  Nodes nodes(plan_);
  const int last = static_cast<int>(plan_.step_count()) - 1;
  std::vector<std::uint32_t> wanted;
  std::vector<double> reach2;
  for (const DeferredPoint& p : points) {
    wanted.push_back(nodes.add(p.position, p.row, {}, last));
    nodes.count_from(wanted.back(), p.step);
    reach2.push_back(p.reach2);
  }
  // From the last step back to the first: each level's neighbourhoods name the points of the level before.
  for (int step = last; step >= 0; --step) {
    std::vector<StreamQuery> queries;
    for (std::size_t i = 0; i < wanted.size(); ++i) queries.push_back(nodes.query(wanted[i], reach2[i]));
    slabs_read_ += search_stream(stream_, plan_, loader_, queries);
    std::vector<std::uint32_t> next;
    for (std::size_t i = 0; i < queries.size(); ++i) {
      stop_if_cancelled();
      shorten(plan_, queries[i]);
      nodes.set_file_columns(wanted[i], queries[i].file_columns);
      std::vector<std::uint32_t> list;
      for (std::size_t j = 0; j < queries[i].neighbors.size(); ++j) {
        const Candidate& c = queries[i].neighbors[j];
        const std::size_t before = nodes.size();
        const std::uint32_t node =
            nodes.add(c.position, c.row, plan_.file_columns.empty() ? "" : queries[i].neighbor_columns[j], step - 1);
        if (nodes.size() > before) next.push_back(node);
        list.push_back(node);
      }
      nodes.list(wanted[i]) = std::move(list);
    }
    wanted = std::move(next);
    reach2.assign(wanted.size(), Box::kInf);
  }
  for (std::size_t step = 0; step <= static_cast<std::size_t>(last); ++step) nodes.run(step, tally);

  std::vector<std::byte> results;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    nodes.results(i, results);
    sink.finished({points[i].slab, &points[i].index_in_slab, &points[i].row, results.data(), 1});
  }
}

}  // namespace pointsweep
