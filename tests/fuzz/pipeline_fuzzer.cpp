// SPDX-License-Identifier: MIT
/// Damaged pipelines, as text and as JSON. Each is refused with a UsageError, or its canonical text gives an equal
/// pipeline.
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
