// SPDX-License-Identifier: MIT
#include "pointsweep/connect/bucketed_graph.h"

#include <algorithm>
#include <map>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/row_table.h"

namespace pointsweep {
namespace {

/// Number of edges that the forest takes at once. It is large because each SpanningForest::join() goes through all
/// candidate edges.
constexpr std::size_t kEdgesAtOnce = 1 << 16;

}  // namespace

/// Reads the buckets in order. Opens the points of a bucket, joins its edges, closes the points without later edges.
std::uint64_t grow(SpanningForest& forest, const BucketedGraph& graph, const GrowthOptions& options) {
  BucketedGraph::Points chunk;
  std::vector<ForestEdge> edges, some;
  const auto join = [&] {
    forest.join(edges);
    edges.clear();
  };
  std::uint64_t points = 0;
  std::map<std::uint64_t, std::vector<std::uint64_t>> closing;  // for each bucket, rows of points that close after it
  for (std::size_t b = 0; b < graph.buckets(); ++b) {
    RowTable<std::uint64_t> last;
    std::vector<std::uint64_t> rows;
    for (std::size_t c = 0; c < graph.chunks(b); ++c) {
      stop_if_cancelled();
      graph.read_points(b, c, chunk);
      forest.open(chunk.points, chunk.ballots, rows);
      for (const OpenUntil& mark : chunk.marks) {
        std::uint64_t& until = *last.add(mark.row).first;
        until = std::max(until, mark.last);
      }
    }
    for (std::size_t c = 0; c < graph.chunks(b); ++c) {
      stop_if_cancelled();
      graph.read_edges(b, c, some);
      edges.insert(edges.end(), some.begin(), some.end());
      if (edges.size() >= kEdgesAtOnce) join();
    }
    join();
    points += rows.size();
    if (options.progress) options.progress(points);
    if (options.stays_open) std::erase_if(rows, options.stays_open);
    std::erase_if(rows, [&](std::uint64_t row) {
      const std::uint64_t* until = last.find(row);
      if (until != nullptr) closing[*until].push_back(row);
      return until != nullptr;
    });
    if (const auto now = closing.extract(b)) rows.insert(rows.end(), now.mapped().begin(), now.mapped().end());
    forest.close(rows);
  }
  return points;
}

}  // namespace pointsweep
