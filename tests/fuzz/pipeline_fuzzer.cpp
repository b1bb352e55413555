// SPDX-License-Identifier: MIT
/// Damaged pipelines, as text and as JSON: each is parsed, and comes back from its own text, or is refused as a
/// UsageError.
#include <cstdlib>

#include "pointsweep/error.h"
#include "pointsweep/program/pipeline.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  try {
    const auto stages = pointsweep::parse_pipeline({reinterpret_cast<const char*>(data), size});
    if (pointsweep::parse_pipeline(pointsweep::to_text(stages)) != stages) std::abort();
  } catch (const pointsweep::UsageError&) {
  }
  return 0;
}
