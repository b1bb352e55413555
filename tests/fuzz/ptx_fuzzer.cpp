// SPDX-License-Identifier: MIT
#include "pointsweep/formats/ptx/ptx_reader.h"
#include "tests/fuzz/read_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  pointsweep::read_everything(pointsweep::open_ptx, bytes, size);
  return 0;
}
