// SPDX-License-Identifier: MIT
#include "pointsweep/formats/format.h"
#include "tests/fuzz/read_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  pointsweep::read_everything(pointsweep::kQsplatFormat.open, bytes, size);
  return 0;
}
