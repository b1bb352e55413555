// SPDX-License-Identifier: MIT
/// What a task leaves for the next task of its tile, and all of them for the whole cloud.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/rows/pass_values.h"
#include "pointsweep/storage/encoding.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// What a task leaves of its tile, beside the points of an order round and the records that its pass carries to the
/// next one (NAME.rows).
struct TileState {
  Survey survey;                             ///< of the input
  std::vector<std::vector<std::byte>> mask;  ///< blocks of the selection; none: all rows are left
  std::string carried;                       ///< name of the records; empty: there are none
  std::vector<std::vector<std::byte>> saved_values;
  std::string swept;  ///< name of the results of a sweep that has left a graph

  void encode(Encoder& out) const;
  static TileState decode(Decoder& in);
  /// Seals the state of a task whose objects begin with `name`.
  void seal(Storage& scratch, const std::string& name) const;
  static TileState left(const Storage& scratch, const std::string& name);
};

void seal_values(Storage& scratch, const std::string& key, const CloudValues& values);
CloudValues sealed_values(const Storage& scratch, const std::string& key);

}  // namespace pointsweep
