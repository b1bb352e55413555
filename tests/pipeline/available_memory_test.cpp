// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/available_memory.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMega = 1 << 20;

class AvailableMemory : public testing::Test {
 protected:
  AvailableMemory() {
    put("proc/meminfo", "MemTotal: 9000000 kB\nMemFree: 100 kB\nMemAvailable:    2048000 kB\nBuffers: 1 kB\n");
  }
  void put(const std::string& path, const std::string& content) const {
    std::filesystem::create_directories((folder_ / path).parent_path());
    folder_.write(path, content);
  }
  std::uint64_t available() const { return available_memory(folder_.path()); }

  TemporaryFolder folder_;
};

TEST_F(AvailableMemory, IsWhatTheSystemStatesWithoutGroups) {
  EXPECT_EQ(available(), 2000 * kMega);
  put("proc/self/cgroup", "0::/\n");
  EXPECT_EQ(available(), 2000 * kMega);
  put("sys/fs/cgroup/user/memory.max", "max\n");
  put("proc/self/cgroup", "0::/user\n");
  EXPECT_EQ(available(), 2000 * kMega);
}

TEST_F(AvailableMemory, IsAtMostTheLimitOfTheOutermostGroupAsInAContainer) {
  put("sys/fs/cgroup/memory.max", "104857600\n");
  put("proc/self/cgroup", "0::/../../of the host\n");
  EXPECT_EQ(available(), 100 * kMega);
}

TEST_F(AvailableMemory, IsWhatTheGroupHasLeftWithoutCachedPagesOfFiles) {
  put("proc/self/cgroup", "0::/slice/job\n");
  put("sys/fs/cgroup/slice/job/memory.max", "104857600\n");
  put("sys/fs/cgroup/slice/job/memory.current", "62914560\n");
  EXPECT_EQ(available(), 40 * kMega);
  put("sys/fs/cgroup/slice/job/memory.stat", "anon 1\nactive_file 5242880\ninactive_file 15728640\nslab 3\n");
  EXPECT_EQ(available(), 60 * kMega);
  put("sys/fs/cgroup/slice/job/memory.current", "524288000\n");
  EXPECT_EQ(available(), 0u);
}

TEST_F(AvailableMemory, IsTheLeastOfAllGroupsAround) {
  put("proc/self/cgroup", "0::/slice/job\n");
  put("sys/fs/cgroup/slice/memory.max", "52428800\n");
  put("sys/fs/cgroup/slice/job/memory.max", "104857600\n");
  EXPECT_EQ(available(), 50 * kMega);
  put("sys/fs/cgroup/slice/job/memory.max", "10485760\n");
  EXPECT_EQ(available(), 10 * kMega);
}

TEST_F(AvailableMemory, KnowsGroupsOfTheFirstVersion) {
  put("proc/self/cgroup", "9:name=systemd:/x\n4:cpu,memory:/job:a/step\n0::/\n");
  put("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(available(), 2000 * kMega);
  put("sys/fs/cgroup/memory/job:a/memory.limit_in_bytes", "104857600\n");
  put("sys/fs/cgroup/memory/job:a/memory.usage_in_bytes", "83886080\n");
  put("sys/fs/cgroup/memory/job:a/memory.stat",
      "inactive_file 1\nactive_file 1\ntotal_inactive_file 4194304\ntotal_active_file 6291456\n");
  EXPECT_EQ(available(), 30 * kMega);
}

TEST_F(AvailableMemory, IsAGuessOf1GBWhereTheSystemStatesNone) {
  std::filesystem::remove(folder_ / "proc/meminfo");
  EXPECT_EQ(available(), 1024 * kMega);
}

TEST(MemoryBudget, IsHalfOfTheAvailableMemoryUnlessStated) {
  EXPECT_EQ(memory_budget(123), 123u);
  EXPECT_GT(memory_budget(0), 0u);
}

}  // namespace
}  // namespace pointsweep
