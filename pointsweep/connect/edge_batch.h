// SPDX-License-Identifier: MIT
/// A batch of edges that some points emit together, reduced to the edges that may belong to a spanning forest, and the
/// interface of what takes such batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/connect/row_table.h"

namespace pointsweep {

/// A batch of edges, whose points are numbered in the order in which they are added. The largest edge of a cycle is in
/// no minimum spanning forest of any graph that contains the cycle. So after reduce() a batch of m points has fewer
/// than m edges, however long the lists of neighbours are.
class EdgeBatch {
 public:
  struct Edge {
    std::uint32_t a, b;
    double weight;
    bool flips;
  };

  void clear();
  /// Returns the number of a point in the batch. A new point gets the next number.
  std::uint32_t number_of(const PointKey& point);
  void add(std::uint32_t a, std::uint32_t b, double weight, bool flips) { edges_.push_back({a, b, weight, flips}); }
  void reserve(std::size_t edges) { edges_.reserve(edges); }
  /// Keeps the edges of a minimum spanning forest of the batch, or of any spanning forest if not `weighted`. Drops the
  /// other edges.
  void reduce(bool weighted);

  const std::vector<PointKey>& points() const { return points_; }
  const std::vector<Edge>& edges() const { return edges_; }
  /// Returns the estimated memory for an edge in bytes, if there is one point for every two edges.
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
  /// Returns whether edges have weights and flips. If not, all weights are equal and no edge flips.
  virtual bool weighted() const = 0;
  /// Takes the edges of a batch, and its first `own` points with their ballots (the values from which votes are made).
  /// Several batches may contain the same point. Thread-safe.
  virtual void put(const EdgeBatch& batch, std::size_t own, std::span<const std::byte> ballots) = 0;
};

}  // namespace pointsweep
