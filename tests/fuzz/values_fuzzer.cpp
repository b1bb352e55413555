// SPDX-License-Identifier: MIT
#include "tests/fuzz/decode_everything.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  pointsweep::decode_everything(bytes, size);
  return 0;
}
