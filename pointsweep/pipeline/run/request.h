// SPDX-License-Identifier: MIT
/// A request for a run, and what is checked before the first point is read.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pointsweep/pipeline/rows/other_cloud.h"
#include "pointsweep/pipeline/run/context.h"

namespace pointsweep {

/// A request as users give it, with the plan of its chain.
struct Request {
  InputCloud& cloud;
  const Outputs& outputs;
  const EngineOptions& options;
  const ChainPlan& plan;
};

/// Returns whether the run reads each row once, to write it: it makes nothing, leaves nothing out, and its output needs
/// to know nothing of the points before. Then nothing is surveyed, and no input is decoded into a temporary file. False
/// where the decoders of all threads take more than half of the memory budget.
bool copies_rows(const Request& request);

/// The other clouds that passes read, by pass.
using OtherClouds = std::vector<std::optional<OtherCloud>>;

/// Throws UsageError where an output is an input or another output.
void require_own_files(const Request& request);
/// Throws where there is no folder for temporary data, or no point.
void require_work(const Request& request);
/// Returns the statistics of the input, before the first phase.
Statistics first_counts(const Request& request, const NonfiniteRows& dropped);
/// Throws for a request that can be refused before the first point is read. Returns the names of its attributes.
OutputNames check_request(const Request& request, const RunReport& report);
/// Returns about how many bytes the output puts aside in the temporary folder while it is written.
std::uint64_t bytes_aside(const Request& request, const OutputNames& names);
/// Opens the other clouds. Throws UsageError where one of them is an output.
OtherClouds open_other_clouds(const Request& request, const RunReport& report);
/// Returns the identity of a run that can be resumed; nothing for any other run. Throws UsageError for a request that
/// cannot be resumed.
std::optional<std::string> identity_of(const Request& request, const OtherClouds& others);

}  // namespace pointsweep
