// SPDX-License-Identifier: MIT
/// Edges that some points emit together, without those that cannot be in a spanning forest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/row_table.h"

namespace pointsweep {

/// Points are numbered as they come. An edge that is the largest of a cycle among the edges of a batch is the largest
/// of one among all edges: a batch of m points passes on fewer than m edges, however long the lists of neighbours are.
class EdgeBatch {
 public:
  struct Edge {
    std::uint32_t a, b;
    double weight;
    bool flips;
  };

  void clear();
  /// Returns the number of a point. A new point gets the next number.
  std::uint32_t number_of(const PointKey& point);
  void add(std::uint32_t a, std::uint32_t b, double weight, bool flips) { edges_.push_back({a, b, weight, flips}); }
  void reserve(std::size_t edges) { edges_.reserve(edges); }
  /// Drops all edges except a minimum spanning forest of the batch; if not `weighted`, except any spanning forest.
  void reduce(bool weighted);

  const std::vector<PointKey>& points() const { return points_; }
  const std::vector<Edge>& edges() const { return edges_; }
  /// Returns the bytes for an edge, if every second edge brings a new point.
  static constexpr std::uint64_t bytes_per_edge(bool weighted) {
    constexpr std::uint64_t kNumberBytes = 4 * 16;  // bytes of a point in a table that is a quarter full
    const std::uint64_t sorted = weighted ? sizeof(Edge) + sizeof(std::pair<double, double>) : 0;
    return sizeof(Edge) + sorted + (kNumberBytes + 2 * sizeof(PointKey)) / 2;
  }
  ForestEdge forest_edge(const Edge& edge) const;

 private:
  void sort_edges();

  RowTable<std::uint32_t> numbers_;
  std::vector<PointKey> points_;
  std::vector<Edge> edges_, sorted_;
  std::vector<std::pair<double, double>> order_;  ///< weight and index of an edge
  std::vector<std::uint32_t> parents_;
};

/// Takes the edges that points emit, batch by batch.
class EdgeSink {
 public:
  virtual ~EdgeSink() = default;
  /// Returns whether weights and signs of edges matter.
  virtual bool weighted() const = 0;
  /// Takes the edges of a batch, and its first `own` points with their ballots. Thread-safe. A point may come more than
  /// once.
  virtual void put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) = 0;
};

}  // namespace pointsweep
