// SPDX-License-Identifier: MIT
/// The input of a run as its chain reads it: with row numbers if a stage reads them, otherwise without the octree nodes
/// that the first stages crop away; decoded once if decoding is slow; and as a source of points for streams. Also
/// decides whether slabs can be made from the input on demand, when the sweep reads them, instead of by a distribution
/// pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/storage/local/spill_file.h"

namespace pointsweep {

/// Returns the cloud without the octree nodes of COPC files that a select at the beginning of the chain drops
/// completely: the box of the node lies outside of the box of the select (SelectOperator::extent()) by more than a step
/// of the grid. The boxes of chunks of other files are not trusted. Keeps one chunk if no point would be left, and
/// keeps all nodes if a stage of the chain reads row numbers.
InputCloud cropped_input(const InputCloud& cloud, const ChainPlan& plan);
/// Returns cropped_input(), with row numbers if a stage reads them. `first`: the number of the first row.
InputCloud input_of_chain(const InputCloud& cloud, const ChainPlan& plan, std::uint64_t first = 0);

/// Returns the points of `cloud`, which must outlive the source. After each reading, calls `note` with the number of
/// rows that were read, from any thread.
PointSource source_of(
    InputCloud& cloud, const std::function<void(std::size_t rows)>& note = [](std::size_t) {});

/// The decision whether slabs can be made on demand, taken before the first pass reads a point. The boxes may be wrong:
/// Stream::on_demand() counts the points of each slab before the run relies on the decision.
struct OnDemandOrder {
  std::string why_not;  ///< reason against slabs on demand, as the end of a sentence; empty if they are possible
  /// Boxes that the inputs state for their rows, by ascending row. Empty if the request rules out slabs on demand, or
  /// if rows are left out or an input must be read from its beginning.
  std::vector<RowBox> boxes;
};

/// Returns the number of the first pass of `planned` that puts points in order; the number of passes if none does.
std::size_t first_ordered_pass(const ChainPlan& planned);

/// Decides whether the first pass that puts points in order can make its slabs on demand.
OnDemandOrder on_demand_order(const InputCloud& cloud, const ChainPlan& planned, const EngineOptions& options);

/// Returns the cloud in which all inputs with FileInfo::decode_once are read from one temporary file at `place`, with
/// FileInfo::schema.stride bytes for each point. Decoding once saves time if a run reads its input several times. Fills
/// the file on all threads that fit in half of the memory budget. Throws Error if an input cannot be decoded or the
/// disk is full; of several such inputs, the error names the first. Reports the phase "decoding".
InputCloud decoded_input(const InputCloud& cloud, const EngineOptions& options, const SpillPlace& place);

/// Returns the bytes of the temporary file of decoded_input().
std::uint64_t decoded_input_bytes(const InputCloud& cloud);
/// Returns the line of a dry run that states decoded_input_bytes(); empty for 0 bytes.
std::string decoded_input_text(std::uint64_t bytes);

}  // namespace pointsweep
