// SPDX-License-Identifier: MIT
#include "pointsweep/formats/e57/e57_format.h"
#include "tests/fuzz/read_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  pointsweep::read_everything(pointsweep::open_e57, bytes, size);
  return 0;
}
