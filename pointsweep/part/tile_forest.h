// SPDX-License-Identifier: MIT
/// The minimum spanning forest of a graph whose edges join points of several tiles (docs/adr/0021). Each tile first
/// stores its edges. When the edges between tiles are known, each tile grows its own forest, in which the points at
/// those edges stay open. Then one process joins the supernodes of all forests. spanning_forest.h explains open points
/// and supernodes. In names of objects, NAME stands for the argument `name` or the name of a tile in `names`, KEY for
/// the argument `key`, and TILE for the number of a tile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pointsweep/connect/forest_log.h"
#include "pointsweep/part/tile_catalogue.h"
#include "pointsweep/part/tile_graph.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// Finds the border of each tile from the lists NAME.crossings, which hold a ForestEdge for each edge between a point
/// of the tile and a point of another tile. Seals a TileBorder under KEY-TILE for each tile, then the object KEY.
void find_borders(Storage& scratch, const TileCatalogue& tiles, const std::vector<std::string>& names,
                  const TileGraphSetup& setup, const std::string& key);

/// Grows the forest of a tile from the graph that store_graph() stored under `graph` and the TileBorder under `border`.
/// Seals NAME.labels, which holds the sign of each row and its supernode, and NAME.forest, an OpenForest.
void leave_forest(Storage& scratch, const std::string& graph, const std::string& border, RowsOfTile rows,
                  const TileGraphSetup& setup, const std::string& name);

/// Seals an empty NAME.forest, for a tile without rows.
void leave_no_forest(Storage& scratch, const std::string& name);

/// Joins the supernodes of the forests of all tiles by the edges of their borders. Seals the signs of the supernodes of
/// each tile under KEY-TILE, then the object KEY. Memory: about 450 bytes and the votes for each border point that has
/// edges to later tiles.
void join_forests(Storage& scratch, const std::vector<std::string>& names, const std::string& borders,
                  const TileGraphSetup& setup, const std::string& key);

/// Calls use(row in the tile, label) for each point of a tile with finite coordinates. Only ComponentLabel::flips of
/// the label is set.
void for_each_sign(const Storage& scratch, const std::string& name, const std::string& key, std::size_t tile,
                   const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use);

}  // namespace pointsweep
