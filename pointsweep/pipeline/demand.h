// SPDX-License-Identifier: MIT
/// What a run asks of the memory plan.
#pragma once

#include <cstdint>

#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/pipeline.h"

namespace pointsweep {

/// `whole`: whole records travel along the stream, otherwise positions and `payload` fields.
MemoryDemand memory_demand(const Cloud& cloud, const Survey& survey, const RunOptions& options, bool whole,
                           std::size_t payload, std::uint64_t result_record_bytes);

}  // namespace pointsweep
