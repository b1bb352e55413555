// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/spill_file.h"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/order/slab_store.h"
#include "pointsweep/storage/local/temp_folder.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

std::array<std::byte, 4> word(std::uint32_t value) {
  std::array<std::byte, 4> bytes;
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

TEST(SpillFile, HasNoNameSoThatNothingIsLeftOfIt) {
  const TempFolder folder(fs::temp_directory_path());
  SpillFile file(&folder);
  file.write(file.reserve(4), word(7));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SpillFile, ReachesPastFourGigabytes) {
  const TempFolder folder(fs::temp_directory_path());
  SpillFile file(&folder);
  file.write(file.reserve((std::uint64_t{5} << 30) + 1), word(1));  // a hole of 5 GiB follows
  const std::uint64_t far = file.reserve(4);
  EXPECT_EQ(far, (std::uint64_t{5} << 30) + 1);
  file.write(far, word(2));
  std::array<std::byte, 4> back;
  file.read(far, back);
  EXPECT_EQ(back, word(2));
  file.read(0, back);
  EXPECT_EQ(back, word(1));
  EXPECT_EQ(file.written_bytes(), 8u);
}

TEST(SpillFile, ThatIsTooShortIsReportedAndNotGuessed) {
  const TempFolder folder(fs::temp_directory_path());
  SpillFile file(&folder);
  file.write(file.reserve(4), word(1));
  std::array<std::byte, 8> back;
  EXPECT_THROW(file.read(0, back), Error);
}

TEST(SpillFile, SaysWhatToDoWhenNoSpaceIsLeft) {
  std::string small = (fs::temp_directory_path() / "small-disk-XXXXXX").string();
  ASSERT_NE(::mkdtemp(small.data()), nullptr);
  if (::mount("tmpfs", small.c_str(), "tmpfs", 0, "size=256k") != 0) {
    fs::remove(small);
    GTEST_SKIP() << "a small file system can be mounted by root only";
  }
  std::string message;
  {
    const TempFolder folder(small);
    SlabStore store(4, 16, 16384, &folder);
    const std::vector<std::byte> records(16 * 1024);
    try {
      for (std::size_t i = 0; i < 64; ++i) store.append(i % 4, records);
    } catch (const Error& error) {
      message = error.what();
    }
  }
  ::umount(small.c_str());
  fs::remove(small);
  EXPECT_NE(message.find("no space left"), std::string::npos) << message;
  EXPECT_NE(message.find(small), std::string::npos) << message;
  EXPECT_NE(message.find("--temp-dir"), std::string::npos) << message;
}

}  // namespace
}  // namespace pointsweep
