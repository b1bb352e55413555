// SPDX-License-Identifier: MIT
#include "pointsweep/formats/npy/npy_format.h"
#include "tests/fuzz/read_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  pointsweep::read_everything(pointsweep::open_npy_points, bytes, size);
  return 0;
}
