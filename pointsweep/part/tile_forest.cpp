// SPDX-License-Identifier: MIT
#include "pointsweep/part/tile_forest.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <optional>

#include "pointsweep/cancellation.h"
#include "pointsweep/connect/bucketed_graph.h"
#include "pointsweep/connect/row_table.h"
#include "pointsweep/connect/spanning_forest.h"
#include "pointsweep/fail.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/part/record_list.h"
#include "pointsweep/part/stored_graph.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {
namespace {

constexpr Encoding kSignsEncoding{"signs of supernodes", 1};

std::string of_tile(const std::string& key, std::size_t tile) { return key + "-" + std::to_string(tile); }

/// An end of an edge between tiles: the row of the point, and the later of the two tiles of the edge.
struct BorderEnd {
  std::uint64_t row, last;

  friend auto operator<=>(const BorderEnd&, const BorderEnd&) = default;
};

/// An edge between tiles, and the later of its two tiles.
struct BorderEdge {
  std::uint64_t later;
  ForestEdge edge;

  bool operator<(const BorderEdge& other) const {
    return later != other.later ? later < other.later : edge < other.edge;
  }
};

/// A record of NAME.labels: the sign of a point. If all points of its component lie in the tile, the sign is final;
/// otherwise it is relative to the supernode of the point.
struct SignOfPoint {
  /// Value of `supernode` for a point whose component lies only in this tile.
  static constexpr std::uint64_t kWhole = ComponentLabel::kNone;
  std::uint64_t supernode;
  bool flips;

  std::uint64_t record() const { return 2 * (supernode + 1) + (flips ? 1 : 0); }
  static SignOfPoint of(std::uint64_t record) { return {record / 2 - 1, record % 2 == 1}; }
};

OpenForest forest_left(const Storage& scratch, const std::string& name, const VoteRule* votes) {
  return sealed_value(scratch, name + ".forest",
                      [&](Decoder& in) { return decode_open_forest(in, OpenVotes(votes).bytes()); });
}

void seal_forest(Storage& scratch, const std::string& name, const OpenForest& forest) {
  Encoder out;
  encode(out, forest);
  seal_bytes(scratch, name + ".forest", out.bytes());
}

bool turns(const VoteRule* votes, const std::byte* component) {
  return votes != nullptr && votes->turns(component + sizeof(FinishedComponent));
}

/// Seals the signs of the supernodes of each tile under KEY-TILE. `signs` holds one byte for each supernode, tile after
/// tile; `ends` holds the number of supernodes up to the end of each tile.
void seal_signs(Storage& scratch, RowStore& signs, const std::vector<std::uint64_t>& ends, const std::string& key) {
  std::vector<std::byte> of_one;
  std::size_t tile = 0;
  const auto seal = [&] {
    Encoder out;
    out.begin(kSignsEncoding);
    out.put_bytes(of_one);
    seal_bytes(scratch, of_tile(key, tile++), out.bytes());
    of_one.clear();
  };
  signs.drain([&](std::uint64_t first, std::span<const std::byte> some) {
    for (std::size_t i = 0; i < some.size(); ++i) {
      while (first + i == ends[tile]) seal();
      of_one.push_back(some[i]);
    }
  });
  while (tile < ends.size()) seal();
}

}  // namespace

void find_borders(Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                  const TileGraphSetup& setup, const std::string& key) {
  const auto crossings_of = [&](std::size_t t) {
    return RecordList(scratch, names[t] + ".crossings", sizeof(ForestEdge));
  };
  std::uint64_t count = 0;
  for (std::size_t t = 0; t < names.size(); ++t) count += crossings_of(t).count();
  SortedRecords<BorderEnd, std::less<>> ends(setup.make_scratch, setup.memory_bytes / 4, 2 * count);
  SortedRecords<BorderEdge, std::less<>> edges(setup.make_scratch, setup.memory_bytes / 2, count);
  for (std::size_t t = 0; t < names.size(); ++t)
    for_each_piece<ForestEdge>(crossings_of(t), [&](std::uint64_t, std::span<const ForestEdge> some) {
      for (const ForestEdge& edge : some) {
        const std::uint64_t later = std::max(tiles.tile_of(edge.a.row), tiles.tile_of(edge.b.row));
        edges.add({later, edge});
        for (const std::uint64_t row : {edge.a.row, edge.b.row}) ends.add({row, later});
      }
    });
  ends.finish();
  edges.finish();
  std::optional<BorderEnd> end = ends.next();
  std::optional<BorderEdge> edge = edges.next();
  for (std::size_t t = 0; t < names.size(); ++t) {
    stop_if_cancelled();
    TileBorder border;
    const RowsOfTile rows{tiles.tiles[t].first_row, tiles.tiles[t].rows};
    for (; end && rows.has(end->row); end = ends.next()) {
      if (border.points.empty() || border.points.back().row != end->row) border.points.push_back({end->row, 0});
      border.points.back().last = end->last;
    }
    for (std::optional<BorderEdge> last; edge && edge->later == t; last = edge, edge = edges.next())
      if (!last || *last < *edge) border.edges.push_back(edge->edge);
    seal_bytes(scratch, of_tile(key, t), encoded(border));
  }
  seal_bytes(scratch, key, {});
}

void leave_forest(Storage& scratch, const std::string& graph, const std::string& border, RowsOfTile rows,
                  const TileGraphSetup& setup, const std::string& name) {
  const VoteRule* const votes = setup.votes;
  const StoredGraph edges(scratch, graph, OpenVotes(votes).ballot_bytes());
  RowTable<bool> open;
  for (const TileBorder::Point& point : sealed_value<TileBorder>(scratch, border).points) open.add(point.row);
  ForestLog log(setup.make_scratch, OpenVotes(votes).concluded_bytes());
  SpanningForest forest(true, votes, log);
  const auto stays_open = [&](std::uint64_t row) { return open.find(row) != nullptr; };
  grow(forest, edges, {stays_open, setup.progress});
  const std::uint64_t whole = log.components().count();
  seal_forest(scratch, name, forest.leave());
  log.finish();
  RowStore labels = store_of_labels(rows.count, setup);
  BatchedRows put(labels, sizeof kNoLabel);
  const auto label_of = [&](std::uint64_t component, const std::byte* record) {
    if (component < whole) return ComponentLabel{.number = SignOfPoint::kWhole, .flips = turns(votes, record)};
    return ComponentLabel{.number = component - whole};
  };
  log.for_each_point(label_of, [&](std::uint64_t row, const ComponentLabel& label) {
    const std::uint64_t record = SignOfPoint{label.number, label.flips}.record();
    std::memcpy(put.add(row - rows.first), &record, sizeof record);
  });
  put.flush();
  RecordListWriter list(scratch, name + ".labels", sizeof kNoLabel);
  labels.drain([&](std::uint64_t, std::span<const std::byte> records) { list.append(records); });
  list.seal();
}

void leave_no_forest(Storage& scratch, const std::string& name) { seal_forest(scratch, name, {}); }

/// Builds the forest of all tiles. For each tile in order: adopts the supernodes of the tile's forest, joins them by
/// the edges between this tile and earlier tiles, and closes the open points of this and earlier tiles that have no
/// edges to later tiles.
void join_forests(Storage& scratch, const std::vector<std::string>& names, const std::string& borders,
                  const TileGraphSetup& setup, const std::string& key) {
  ForestLog log(setup.make_scratch, OpenVotes(setup.votes).concluded_bytes());
  SpanningForest forest(true, setup.votes, log);
  std::map<std::uint64_t, std::vector<std::uint64_t>> closing;  // for each tile, rows of the points that close after it
  std::vector<std::uint64_t> ends;                              // for each tile, number of supernodes up to its end
  std::uint64_t supernodes = 0;
  for (std::size_t t = 0; t < names.size(); ++t) {
    stop_if_cancelled();
    const OpenForest left = forest_left(scratch, names[t], setup.votes);
    const auto border = sealed_value<TileBorder>(scratch, of_tile(borders, t));
    forest.adopt(left, supernodes);
    ends.push_back(supernodes += left.supernodes.size());
    forest.join(border.edges);
    for (const TileBorder::Point& point : border.points) closing[point.last].push_back(point.row);
    if (const auto now = closing.extract(t)) forest.close(now.mapped());
  }
  log.finish();
  RowStore signs(supernodes, {std::byte{0}}, setup.spill, std::max<std::uint64_t>(setup.memory_bytes / 4, 1 << 20));
  BatchedRows put(signs, 1);
  const auto label_of = [&](std::uint64_t, const std::byte* record) {
    return ComponentLabel{.flips = turns(setup.votes, record)};
  };
  log.for_each_point(label_of, [&](std::uint64_t supernode, const ComponentLabel& label) {
    *put.add(supernode) = std::byte{label.flips};
  });
  put.flush();
  seal_signs(scratch, signs, ends, key);
  seal_bytes(scratch, key, {});
}

void for_each_sign(const Storage& scratch, const std::string& name, const std::string& key, std::size_t tile,
                   const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use) {
  const std::vector<std::byte> signs = sealed_value(scratch, of_tile(key, tile), [](Decoder& in) {
    in.begin(kSignsEncoding);
    return in.get_bytes();
  });
  const RecordList list(scratch, name + ".labels", sizeof kNoLabel);
  for_each_piece<std::uint64_t>(list, [&](std::uint64_t first, std::span<const std::uint64_t> labels) {
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] == kNoLabel) continue;
      SignOfPoint point = SignOfPoint::of(labels[i]);
      if (point.supernode != SignOfPoint::kWhole) {
        if (point.supernode >= signs.size()) fail("{}.labels: is damaged.", name);
        point.flips ^= signs[point.supernode] != std::byte{0};
      }
      use(first + i, {.flips = point.flips});
    }
  });
}

}  // namespace pointsweep
