// SPDX-License-Identifier: MIT
/// A request for a run, and checks of the request, none of which reads a point.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/run/context.h"

namespace pointsweep {

/// A request of a user, with the plan of its chain. The cloud may lack rows that a run drops before its first phase.
struct Request {
  InputCloud& cloud;
  const Outputs& outputs;
  const EngineOptions& options;
  const ChainPlan& plan;
};

/// Returns the plan of a sort(): no passes, only the order of the output.
ChainPlan plan_sort(const Schema& input, const std::vector<std::string>& keep);

/// Returns whether the run only copies rows in input order: it makes no attributes, drops no rows, and its output needs
/// no facts about all points. Such a run has no survey and decodes no input into a temporary file. False for tiles, for
/// a run that can be resumed, for the reference engine, and if the decoders of all threads would take more than half of
/// the memory budget.
bool copies_rows(const Request& request);

/// Returns whether a stage reads attributes of the input, or attributes that an earlier pass has made.
bool reads_attributes(const ChainPlan& plan);

/// The other clouds that a run reads: one entry for each pass, absent if the pass reads no other cloud.
using OtherClouds = std::vector<std::optional<OtherCloud>>;

/// Throws UsageError if an output is also an input or another output, or if the folder of a divided output holds an
/// input.
void require_own_files(const Request& request);
/// Returns the error that a run would throw for the first output that cannot be written, such as a file that exists;
/// empty if it would throw none. Does not look at the files of a divided output or of a folder that the run makes.
std::string obstacle_to_outputs(const Outputs& outputs, const EngineOptions& options);
/// Throws Error if the user names a temporary folder that cannot be used, or if the input has no points.
void require_work(const Request& request);
/// Returns the statistics that are known before the first phase: counts, warnings of the inputs, threads and memory.
Statistics first_counts(const Request& request, const NonfiniteRows& dropped);
/// Throws for errors that can be found before the first point is read, and reports warnings and notes. Returns the
/// names of attributes in the outputs.
OutputNames check_request(const Request& request, const RunReport& report);
/// Throws the error that the writer of the output would throw later if files of its format cannot hold the records.
/// Checks only formats with Format::stored_coordinate, and not the tiles of a folder.
void require_layout(const Request& request, const OutputNames& names);
/// Returns an estimate of the bytes that the output stores in the temporary folder while it is written; 0 for tiles and
/// for a divided output.
std::uint64_t bytes_aside(const Request& request, const OutputNames& names);
/// Opens the other clouds. Throws UsageError if one of them is an output.
OtherClouds open_other_clouds(const Request& request, const RunReport& report);
/// Returns the identity of a run that stores checkpoints; absent for any other run. Throws UsageError for a request
/// that cannot be resumed.
std::optional<std::string> identity_of(const Request& request, const OtherClouds& others);

}  // namespace pointsweep
