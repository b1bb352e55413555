// SPDX-License-Identifier: MIT
/// The tasks of many processes that divide the points of a cloud among files (`tile`, `split`). Each task of the first
/// round cuts a range of the rows into pieces, one for each file; each task of the second round writes some of the
/// files from the pieces of all ranges. All tasks open all inputs, so that they plan the same layout for the output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A request for a run that many processes share.
struct SharedRequest {
  InputCloud& cloud;  ///< one tile or all inputs, as the function says that gets the request
  const Chain& chain;
  const Outputs& outputs;
  const EngineOptions& options;
};

/// Resolves the chain against the fields of the cloud.
ChainPlan plan_of(const SharedRequest& request);

// The requests of the functions below have all inputs, and only divide their points: the chain has no stages and names
// the attributes to keep; Outputs::points is the path of the files, with a * for the name of each.

/// Returns the number of rows of each range. Throws UsageError for a chain with stages, for inputs from which nonfinite
/// points must be dropped, and if the layout of the output depends on all points.
std::vector<std::uint64_t> plan_ranges(const SharedRequest& request);
/// Returns the bytes of the record of a point in the pieces. Throws for outputs that cannot be written, as far as this
/// is known before the work.
std::uint64_t piece_bytes(const SharedRequest& request);

struct RowRange {
  std::uint64_t first = 0, rows = 0;
};
/// Divides the rows of a range among files. Stores the records under `name`.pieces and their PiecesOfRange under
/// `name`.cut in `scratch`, which all processes share. The options of cut_range() and write_pieces() must allow files
/// to be replaced, since plan_parts() and join_pieces() refuse existing files.
Statistics cut_range(const SharedRequest& request, RowRange range, Storage& scratch, const std::string& name);

/// Performs PartJoin::pieces: seals the list of all files and their pieces (FilesOfRanges) under `key`. `names`: names
/// given to cut_range(), in the order of the ranges. Throws if one of the files cannot be written.
void join_pieces(const SharedRequest& request, Storage& scratch, const std::vector<std::string>& names,
                 const std::string& key);

/// Writes the files of task `task`, counted from 0, of `tasks` tasks. `key`: key given to join_pieces().
Statistics write_pieces(const SharedRequest& request, std::size_t task, std::size_t tasks, const Storage& scratch,
                        const std::string& key);

}  // namespace pointsweep
