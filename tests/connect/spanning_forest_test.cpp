// SPDX-License-Identifier: MIT
/// The forest of open points against Kruskal's algorithm on the whole graph in memory.
#include "pointsweep/connect/spanning_forest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/support/scratch_in_memory.h"

namespace pointsweep {
namespace {

/// A graph over points whose rows are shuffled. With rows in the order of the keys, a wrong order would not be seen.
struct Graph {
  std::vector<PointKey> points;  ///< by row
  std::vector<ForestEdge> edges;

  /// Adds an edge unless the two points have one. So the weight and the sign of an edge are functions of its points.
  void add(std::uint64_t a, std::uint64_t b, double weight, bool flips) {
    if (!joined_.insert({std::min(a, b), std::max(a, b)}).second) return;
    if (points[b] < points[a]) std::swap(a, b);
    edges.push_back({weight, points[a], points[b], flips});
  }

 private:
  std::set<std::pair<std::uint64_t, std::uint64_t>> joined_;
};

Graph graph_of(std::size_t n, std::mt19937_64& random) {
  Graph graph;
  std::vector<double> x(n);
  std::iota(x.begin(), x.end(), -0.5 * static_cast<double>(n));
  std::ranges::shuffle(x, random);
  for (std::size_t i = 0; i < n; ++i) graph.points.push_back({{x[i], 0, 0}, i});
  return graph;
}

struct PointResult {
  std::uint64_t first;  ///< row of the first point of its component
  std::uint64_t size;
  bool differs;  ///< true if its sign differs from that of the first point of its component
  std::int64_t votes;
  bool operator==(const PointResult&) const = default;
};

/// Votes by the sum of the rows, each with the sign of its point relative to the first point of the component.
class SumOfRows final : public VoteRule {
 public:
  std::size_t ballot_bytes() const override { return 1; }
  std::size_t bytes() const override { return sizeof(std::int64_t); }
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override {
    const auto row = static_cast<std::int64_t>(point.row);
    EXPECT_EQ(*ballot, std::byte(point.row));
    std::memcpy(votes, &row, sizeof row);
  }
  void merge(std::byte* into, const std::byte* from, bool flips) const override {
    const std::int64_t sum = of(into) + (flips ? -of(from) : of(from));
    std::memcpy(into, &sum, sizeof sum);
  }
  std::size_t result_bytes() const override { return bytes(); }
  void conclude(const std::byte* votes, std::byte* result) const override { std::copy_n(votes, bytes(), result); }
  bool turns(const std::byte* result) const override { return of(result) < 0; }
  static std::int64_t of(const std::byte* votes) {
    std::int64_t sum;
    std::memcpy(&sum, votes, sizeof sum);
    return sum;
  }
};

/// Returns the results by Kruskal's algorithm: all edges in their order, with the signs of points relative to their
/// sets.
std::vector<PointResult> in_memory(const Graph& graph, bool weighted) {
  const std::size_t n = graph.points.size();
  std::vector<std::vector<std::size_t>> members(n);
  std::vector<std::size_t> set(n);
  std::vector<bool> sign(n);
  for (std::size_t i = 0; i < n; ++i) members[i] = {i}, set[i] = i;
  std::vector<ForestEdge> edges = graph.edges;
  std::ranges::sort(edges, [](const ForestEdge& e, const ForestEdge& f) {
    const auto key = [](const ForestEdge& g) {
      return std::tuple(g.weight, g.a.position.x, g.a.row, g.b.position.x, g.b.row);
    };
    return key(e) < key(f);
  });
  for (const ForestEdge& e : edges) {
    const std::size_t a = set[e.a.row], b = set[e.b.row];
    if (a == b) continue;
    const bool turn = weighted && (sign[e.a.row] ^ sign[e.b.row]) != e.flips;
    for (const std::size_t i : members[b]) set[i] = a, sign[i] = sign[i] ^ turn, members[a].push_back(i);
    members[b].clear();
  }
  std::vector<PointResult> results(n);
  for (const auto& points : members) {
    if (points.empty()) continue;
    const std::size_t first =
        *std::ranges::min_element(points, {}, [&](std::size_t i) { return std::pair(graph.points[i].position.x, i); });
    std::int64_t votes = 0;
    for (const std::size_t i : points) votes += (sign[i] == sign[first] ? 1 : -1) * static_cast<std::int64_t>(i);
    for (const std::size_t i : points) results[i] = {first, points.size(), sign[i] != sign[first], votes};
  }
  return results;
}

struct Streamed {
  std::vector<PointResult> results;
  std::size_t peak_supernodes = 0, most_open = 0, most_candidates = 0;
};

struct LoggedForest {
  LoggedForest(bool weighted, const VoteRule& rule)
      : log([]() -> std::unique_ptr<Scratch> { return std::make_unique<ScratchInMemory>(); }, rule.result_bytes()),
        forest(weighted, &rule, log) {}

  ForestLog log;
  SpanningForest forest;
};

/// The components and signs of all points, read from the logs of forests.
class LabelsOfPoints {
 public:
  explicit LabelsOfPoints(std::size_t points) : labels_(points) {}

  void take(const ForestLog& log) {
    take(log, [](std::uint64_t row, auto put) { put(row, false); });
  }
  /// `points_of(row, put)` calls put(row, flips) for each point of supernode `row` of the log.
  template <class PointsOf>
  void take(const ForestLog& log, PointsOf points_of) {
    const std::size_t first = add(log);
    log.for_each_point(label_of(first), [&](std::uint64_t known, const ComponentLabel& label) {
      EXPECT_EQ(SumOfRows::of(label.result), votes_[label.number]);
      points_of(known, [&](std::uint64_t row, bool flips) { set(row, label.number, label.flips != flips); });
    });
  }
  /// Components from number `whole` on are supernodes: their points are passed to use(row, supernode, flips).
  template <class Use>
  void take(const ForestLog& log, std::size_t whole, Use use) {
    const std::size_t first = add(log);
    log.for_each_point(label_of(first), [&](std::uint64_t row, const ComponentLabel& label) {
      if (label.number - first >= whole) return use(row, label.number - first - whole, label.flips);
      set(row, label.number, label.flips);
    });
  }
  std::vector<PointResult> results() const {
    std::vector<PointResult> results;
    for (const Label& label : labels_) {
      EXPECT_TRUE(label.is_set);
      const FinishedComponent& c = components_[label.component];
      const bool first_flips = labels_[c.first.row].flips;
      const std::int64_t votes = votes_[label.component];
      results.push_back({c.first.row, c.points, label.flips != first_flips, first_flips ? -votes : votes});
    }
    return results;
  }

 private:
  struct Label {
    std::size_t component = 0;
    bool flips = false, is_set = false;
  };
  std::size_t add(const ForestLog& log) {
    const std::size_t first = components_.size();
    components_.resize(first + log.components().count());
    votes_.resize(components_.size());
    return first;
  }
  std::function<ComponentLabel(std::uint64_t, const std::byte*)> label_of(std::size_t first) {
    return [this, first](std::uint64_t c, const std::byte* record) {
      std::memcpy(&components_[first + c], record, sizeof(FinishedComponent));
      votes_[first + c] = SumOfRows::of(record + sizeof(FinishedComponent));
      return ComponentLabel{.number = first + c};
    };
  }
  void set(std::uint64_t row, std::size_t component, bool flips) {
    EXPECT_FALSE(labels_[row].is_set);
    labels_[row] = {component, flips, true};
  }

  std::vector<Label> labels_;
  std::vector<FinishedComponent> components_;
  std::vector<std::int64_t> votes_;
};

/// Builds the forest from batches: edge e comes in batch batch_of[e]. A point is open from the batch of its first edge
/// to the batch of its last edge; a point without edges, for one batch.
Streamed streamed(const Graph& graph, const std::vector<std::size_t>& batch_of, bool weighted) {
  const std::size_t n = graph.points.size();
  const std::size_t batches = batch_of.empty() ? 1 : *std::ranges::max_element(batch_of) + 1;
  constexpr std::size_t kNever = ~std::size_t{0};
  std::vector<std::size_t> from(n, kNever), to(n, 0);
  for (std::size_t e = 0; e < graph.edges.size(); ++e)
    for (const std::uint64_t row : {graph.edges[e].a.row, graph.edges[e].b.row})
      from[row] = std::min(from[row], batch_of[e]), to[row] = std::max(to[row], batch_of[e]);
  for (std::size_t i = 0; i < n; ++i)
    if (from[i] == kNever) from[i] = to[i] = i % batches;
  const SumOfRows rule;
  const auto made = std::make_unique<LoggedForest>(weighted, rule);
  Streamed out;
  std::vector<std::vector<std::size_t>> opened(batches), closed(batches), edges(batches);
  for (std::size_t i = 0; i < n; ++i) opened[from[i]].push_back(i), closed[to[i]].push_back(i);
  for (std::size_t e = 0; e < batch_of.size(); ++e) edges[batch_of[e]].push_back(e);
  for (std::size_t b = 0; b < batches; ++b) {
    SpanningForest& forest = made->forest;
    std::vector<PointKey> points;
    std::vector<std::byte> ballots;
    for (const std::size_t i : opened[b]) {
      points.push_back(graph.points[i]);
      ballots.push_back(std::byte(i));
    }
    std::vector<std::uint64_t> opened_rows;
    forest.open(points, ballots, opened_rows);
    EXPECT_EQ(opened_rows.size(), points.size());
    std::vector<ForestEdge> batch;
    for (const std::size_t e : edges[b]) batch.push_back(graph.edges[e]);
    const auto half = static_cast<std::ptrdiff_t>(batch.size() / 2);
    forest.join(std::span(batch).first(static_cast<std::size_t>(half)));
    forest.join(std::span(batch).last(batch.size() - static_cast<std::size_t>(half)));
    std::vector<std::uint64_t> rows(closed[b].begin(), closed[b].end());
    forest.close(rows);
    out.most_open = std::max(out.most_open, forest.open_points());
    out.most_candidates = std::max(out.most_candidates, forest.candidates());
    EXPECT_LE(forest.supernodes(), forest.open_points());
  }
  EXPECT_EQ(made->forest.open_points(), 0u);
  EXPECT_EQ(made->forest.supernodes(), 0u);
  ForestLog& log = made->log;
  log.finish();
  out.peak_supernodes = made->forest.slots();
  out.results.resize(n);
  LabelsOfPoints labels(n);
  labels.take(log);
  out.results = labels.results();
  return out;
}

/// Builds a forest for each tile from the edges inside the tile, and joins the forests. The points in `stays_open` and
/// the ends of edges between tiles stay open. Edges come in batches, as in streamed().
std::vector<PointResult> joined(const Graph& graph, const std::vector<std::size_t>& tile_of, std::size_t tiles,
                                const std::vector<std::size_t>& batch_of, const std::vector<bool>& stays_open,
                                bool weighted) {
  const std::size_t n = graph.points.size();
  const SumOfRows rule;
  std::vector<std::size_t> last_tile(n), last_batch(n);
  for (std::size_t i = 0; i < n; ++i) last_tile[i] = tile_of[i];
  std::vector<std::vector<std::vector<ForestEdge>>> own(tiles);
  std::vector<std::vector<ForestEdge>> across(tiles);
  std::vector<bool> is_open = stays_open;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const ForestEdge& edge = graph.edges[e];
    const std::size_t a = edge.a.row, b = edge.b.row, later = std::max(tile_of[a], tile_of[b]);
    if (tile_of[a] != tile_of[b]) {
      across[later].push_back(edge);
      for (const std::size_t i : {a, b}) last_tile[i] = std::max(last_tile[i], later), is_open[i] = true;
    } else {
      own[later].resize(std::max(own[later].size(), batch_of[e] + 1));
      own[later][batch_of[e]].push_back(edge);
      for (const std::size_t i : {a, b}) last_batch[i] = std::max(last_batch[i], batch_of[e]);
    }
  }
  LabelsOfPoints labels(n);
  const auto join = std::make_unique<LoggedForest>(weighted, rule);
  std::vector<std::vector<std::size_t>> members;  // by supernode
  std::vector<bool> turned(n);                    // by row: sign relative to the supernode of the point
  for (std::size_t t = 0; t < tiles; ++t) {
    const auto tile = std::make_unique<LoggedForest>(weighted, rule);
    std::vector<std::uint64_t> rows;
    own[t].resize(std::max<std::size_t>(own[t].size(), 1));
    for (std::size_t i = 0; i < n; ++i)
      if (tile_of[i] == t) tile->forest.open({&graph.points[i], 1}, std::vector{std::byte(i)}, rows);
    for (std::size_t b = 0; b < own[t].size(); ++b) {
      tile->forest.join(own[t][b]);
      std::vector<std::uint64_t> close;
      for (const std::uint64_t row : rows)
        if (!is_open[row] && last_batch[row] == b) close.push_back(row);
      tile->forest.close(close);
    }
    const std::size_t whole = tile->log.components().count(), before = members.size();
    const OpenForest left = tile->forest.leave();
    EXPECT_EQ(static_cast<std::ptrdiff_t>(left.points.size()),
              std::ranges::count_if(rows, [&](std::uint64_t row) { return is_open[row]; }));
    EXPECT_LE(left.supernodes.size(), left.points.size());
    EXPECT_LE(left.candidates.size(), left.supernodes.size());
    members.resize(before + left.supernodes.size());
    tile->log.finish();
    labels.take(tile->log, whole, [&](std::uint64_t row, std::uint64_t supernode, bool flips) {
      members[before + supernode].push_back(row);
      turned[row] = flips;
    });
    join->forest.adopt(left, before);
    join->forest.join(across[t]);
    std::vector<std::uint64_t> close;
    for (std::size_t i = 0; i < n; ++i)
      if (is_open[i] && last_tile[i] == t) close.push_back(i);
    join->forest.close(close);
  }
  EXPECT_EQ(join->forest.open_points(), 0u);
  EXPECT_EQ(join->forest.supernodes(), 0u);
  join->log.finish();
  labels.take(join->log, [&](std::uint64_t supernode, auto put) {
    for (const std::size_t i : members[supernode]) put(i, turned[i]);
  });
  return labels.results();
}

/// Returns a weight: equal for all edges (kind 0), one of few values (1), or different for most edges (2).
double weight_of(std::size_t kind, std::mt19937_64& random) {
  return kind == 0 ? 1 : kind == 1 ? static_cast<double>(random() % 3) : static_cast<double>(random() % 1'000'000);
}

std::map<std::string, Graph> hostile_graphs(std::size_t n, std::size_t kind, std::mt19937_64& random) {
  std::map<std::string, Graph> graphs;
  const auto fresh = [&](const char* name) -> Graph& { return graphs[name] = graph_of(n, random); };
  const auto join = [&](Graph& g, std::size_t a, std::size_t b) {
    if (a != b) g.add(a, b, weight_of(kind, random), random() % 2 == 0);
  };
  Graph& sparse = fresh("many components and isolated points");
  for (std::size_t e = 0; e < n / 2; ++e) join(sparse, random() % n, random() % n);
  Graph& dense = fresh("dense");
  for (std::size_t e = 0; e < 6 * n; ++e) join(dense, random() % n, random() % n);
  Graph& chain = fresh("one chain");
  for (std::size_t i = 0; i + 1 < n; ++i) join(chain, i, i + 1);
  Graph& comb = fresh("a comb that joins at its end");
  const std::size_t teeth = 10, length = n / teeth;
  for (std::size_t t = 0; t < teeth; ++t)
    for (std::size_t i = 0; i + 1 < length; ++i) join(comb, t * length + i, t * length + i + 1);
  for (std::size_t t = 0; t + 1 < teeth; ++t) join(comb, (t + 1) * length - 1, (t + 2) * length - 1);
  Graph& star = fresh("a star");
  for (std::size_t i = 1; i < n; ++i) join(star, 0, i);
  Graph& band = fresh("a band");
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 1; j < 6; ++j)
      if (i + j < n && random() % 3 != 0) join(band, i, i + j);
  Graph& twice = fresh("every edge twice, places used twice");
  for (std::size_t i = 0; i + 1 < n; i += 2) twice.points[i].position = twice.points[i + 1].position;
  for (std::size_t e = 0; e < 2 * n; ++e) join(twice, random() % n, random() % n);
  const std::vector<ForestEdge> edges = twice.edges;
  twice.edges.insert(twice.edges.end(), edges.begin(), edges.end());
  fresh("no edges");
  return graphs;
}

/// Returns divisions of the edges into batches: all at once, one by one, at random, in the order of the rows, and in
/// reverse order.
std::vector<std::vector<std::size_t>> divisions(const Graph& graph, std::mt19937_64& random) {
  const std::size_t n = graph.edges.size();
  std::vector<std::vector<std::size_t>> all(5, std::vector<std::size_t>(n));
  for (std::size_t e = 0; e < n; ++e) {
    const std::uint64_t last = std::max(graph.edges[e].a.row, graph.edges[e].b.row);
    all[1][e] = e;
    all[2][e] = random() % 37;
    all[3][e] = last / 16;
    all[4][e] = (graph.points.size() - std::min(graph.edges[e].a.row, graph.edges[e].b.row)) / 16;
  }
  std::ranges::shuffle(all[1], random);
  return all;
}

TEST(SpanningForest, IsThatOfKruskalInMemory) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {2u, 30u, 400u}) {
    for (std::size_t kind = 0; kind < 3; ++kind) {
      for (const auto& [name, graph] : hostile_graphs(n, kind, random)) {
        const std::vector<PointResult> expected = in_memory(graph, true);
        std::size_t d = 0;
        for (const auto& batch_of : divisions(graph, random))
          ASSERT_EQ(streamed(graph, batch_of, true).results, expected)
              << name << ", " << n << " points, weights " << kind << ", division " << d++;
      }
    }
  }
}

/// Points are in random tiles: all points or few points lie at a border, and some tiles are empty.
TEST(SpanningForest, IsJoinedFromThoseOfTiles) {
  std::mt19937_64 random(6);
  for (std::size_t trial = 0; trial < 30; ++trial) {
    const bool weighted = trial % 5 != 0;
    for (auto& [name, graph] : hostile_graphs(2 + random() % 90, weighted ? trial % 3 : 0, random)) {
      if (!weighted)
        for (ForestEdge& edge : graph.edges) edge.flips = false;
      const std::size_t n = graph.points.size(), tiles = 1 + random() % 9, in_row = 1 + random() % 30;
      std::vector<std::size_t> tile_of(n), batch_of(graph.edges.size());
      std::vector<bool> stays_open(n);
      for (std::size_t i = 0; i < n; ++i)
        tile_of[i] = i / in_row * 7 % tiles, stays_open[i] = trial % 4 == 1 && random() % 3 == 0;
      for (std::size_t& batch : batch_of) batch = random() % 5;
      ASSERT_EQ(joined(graph, tile_of, tiles, batch_of, stays_open, weighted), in_memory(graph, weighted))
          << name << ", trial " << trial;
    }
  }
}

TEST(SpanningForest, WithoutWeightsTellsTheSameComponents) {
  std::mt19937_64 random(2);
  for (const std::size_t n : {2u, 400u}) {
    for (auto& [name, graph] : hostile_graphs(n, 0, random)) {
      for (ForestEdge& edge : graph.edges) edge.flips = false;
      const std::vector<PointResult> expected = in_memory(graph, false);
      for (const auto& batch_of : divisions(graph, random)) {
        const Streamed got = streamed(graph, batch_of, false);
        ASSERT_EQ(got.results, expected) << name;
        EXPECT_EQ(got.most_candidates, 0u);
      }
    }
  }
}

TEST(SpanningForest, TakesRandomGraphsInRandomBatches) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    Graph graph = graph_of(2 + random() % 60, random);
    const std::size_t n = graph.points.size(), batches = 1 + random() % 20;
    std::vector<std::size_t> batch_of;
    for (std::size_t e = random() % (4 * n); e > 0; --e) {
      const std::uint64_t a = random() % n, b = random() % n;
      if (a != b) graph.add(a, b, weight_of(trial % 3, random), random() % 2 == 0);
    }
    for (std::size_t e = 0; e < graph.edges.size(); ++e) batch_of.push_back(random() % batches);
    ASSERT_EQ(streamed(graph, batch_of, true).results, in_memory(graph, true)) << "trial " << trial;
  }
}

/// The memory of a forest is proportional to the number of open points, for any length of a chain.
TEST(SpanningForest, HoldsNoMoreThanIsOpen) {
  for (const bool weighted : {false, true}) {
    std::size_t before = 0;
    for (const std::size_t n : {4000u, 40'000u}) {
      std::mt19937_64 random(4);
      Graph graph = graph_of(n, random);
      std::vector<std::size_t> batch_of;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 1; j < 4; ++j)
          if (i + j < n)
            graph.add(i, i + j, weight_of(2, random), weighted && random() % 2 == 0), batch_of.push_back((i + j) / 100);
      const Streamed got = streamed(graph, batch_of, weighted);
      EXPECT_LE(got.most_open, 3u);
      EXPECT_LE(got.most_candidates, 2u);
      EXPECT_LE(got.peak_supernodes, 103u);
      EXPECT_TRUE(before == 0 || got.peak_supernodes == before);
      before = got.peak_supernodes;
    }
  }
}

TEST(RowTable, KnowsWhatAMapKnows) {
  std::mt19937_64 random(5);
  RowTable<std::uint64_t> table;
  std::map<std::uint64_t, std::uint64_t> map;
  for (int i = 0; i < 200'000; ++i) {
    const std::uint64_t row = random() % (i < 100'000 ? 300 : 5000);
    switch (random() % 3) {
      case 0:
        ASSERT_EQ(table.erase(row), map.erase(row) == 1);
        break;
      case 1: {
        const auto [value, is_new] = table.add(row);
        ASSERT_EQ(is_new, !map.contains(row));
        *value = map[row] = random();
        break;
      }
      default:
        const std::uint64_t* found = table.find(row);
        ASSERT_EQ(found != nullptr, map.contains(row));
        ASSERT_TRUE(found == nullptr || *found == map.at(row));
    }
    ASSERT_EQ(table.size(), map.size());
  }
  std::size_t n = 0;
  table.for_each([&](std::uint64_t row, std::uint64_t value) {
    ++n;
    EXPECT_EQ(map.at(row), value);
  });
  EXPECT_EQ(n, map.size());
}

}  // namespace
}  // namespace pointsweep
