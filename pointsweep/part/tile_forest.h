// SPDX-License-Identifier: MIT
/// The minimum spanning forest of a graph whose edges join points of several tiles, in two rounds (docs/adr/0021): each
/// tile leaves its edges; when it is known which of its points edges between tiles name, it grows its forest, in which
/// those points stay open; then one process joins what is left of all forests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pointsweep/connect/forest_log.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/part/tile_reader.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Finds the border of each tile from the lists NAME.crossings, records of ForestEdge between a point of the tile and
/// one of another tile. Leaves a TileBorder under KEY-TILE for each; KEY is there when all are.
void find_borders(Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                  const TileGraphSetup& setup, const std::string& key);

/// Grows the forest of a tile from what store_graph() has left under `graph` and from its border under `border`. Leaves
/// NAME.labels, by row the sign of the point or its supernode, and NAME.forest, an OpenForest.
void leave_forest(Storage& scratch, const std::string& graph, const std::string& border, RowsOfTile rows,
                  const TileGraphSetup& setup, const std::string& name);

/// Leaves NAME.forest of a tile without rows.
void leave_no_forest(Storage& scratch, const std::string& name);

/// Joins what is left of the forests of all tiles by the edges of their borders, and leaves the signs of the supernodes
/// of each tile; KEY is there when all are. Memory: about 450 bytes and the votes of each border point of which edges
/// to later tiles are known.
void join_forests(Storage& scratch, const std::vector<std::string>& names, const std::string& borders,
                  const TileGraphSetup& setup, const std::string& key);

/// Calls use(row in the tile, label) for each point of a tile that has a place. Of a label only `flips` is known.
void for_each_sign(const Storage& scratch, const std::string& name, const std::string& key, std::size_t tile,
                   const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use);

}  // namespace pointsweep
