// SPDX-License-Identifier: MIT
/// Values that tasks of a run on many machines pass on: the state of a tile, and the values of the whole cloud.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/rows/pass_values.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// The state in which a task leaves its tile for the next task. The points that an order round stores and the carried
/// records (NAME.rows) are objects of their own.
struct TileState {
  Survey survey;                                     ///< survey of the tile's input
  std::vector<std::vector<std::byte>> mask;          ///< blocks of the selection of rows; empty if all rows are left
  std::string carried;                               ///< NAME of the carried records; empty if none
  std::vector<std::vector<std::byte>> saved_values;  ///< PassValues::save() of the last pass that has ended
  std::string swept;                                 ///< NAME of the graph that a sweep has stored; empty if none

  void encode(Encoder& out) const;
  static TileState decode(Decoder& in);
  /// Seals the state of a task whose objects begin with `name`.
  void seal(Storage& scratch, const std::string& name) const;
  /// Returns the state that seal() has stored for `name`.
  static TileState left(const Storage& scratch, const std::string& name);
};

void seal_values(Storage& scratch, const std::string& key, const CloudValues& values);
CloudValues sealed_values(const Storage& scratch, const std::string& key);

}  // namespace pointsweep
