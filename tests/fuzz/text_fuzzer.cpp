// SPDX-License-Identifier: MIT
#include "pointsweep/formats/text/text_format.h"
#include "tests/fuzz/read_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  pointsweep::read_everything(pointsweep::open_text, bytes, size);
  return 0;
}
