// SPDX-License-Identifier: MIT
#include "pointsweep/points/text_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

TEST(TextFile, HasNoByteOrderMark) {
  const std::filesystem::path path = testing::TempDir() + "pointsweep-text-" + std::to_string(getpid());
  for (const std::string text : {"", "1 0 0 0", "\xEF\xBB", "a\xEF\xBB\xBF"}) {
    std::ofstream(path) << text;
    EXPECT_EQ(read_text_file(path.string(), "words"), text);
    std::ofstream(path) << kByteOrderMark << text;
    EXPECT_EQ(read_text_file(path.string(), "words"), text);
  }
  std::filesystem::remove(path);
  EXPECT_THROW(read_text_file(path.string(), "words"), Error);
}

}  // namespace
}  // namespace pointsweep
