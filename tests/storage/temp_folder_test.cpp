// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/temp_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <string>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// A parent folder that holds only entries of the test.
class TempFolders : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "temp-folder-test-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    parent_ = name;
  }
  void TearDown() override { fs::remove_all(parent_); }

  fs::path make(const std::string& name) const {
    fs::create_directory(parent_ / name);
    std::ofstream(parent_ / name / "spilled") << "data";
    return parent_ / name;
  }

  fs::path parent_;
};

pid_t pid_of_a_dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST_F(TempFolders, ArePrivateAndVanishWithAllTheyHold) {
  std::optional<TempFolder> folder(std::in_place, parent_);
  const fs::path path = folder->path();
  EXPECT_EQ(path.parent_path(), parent_);
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
  std::ofstream(path / "file") << "data";
  folder.reset();
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(TempFolders, OfOneProcessDoNotMeet) {
  const TempFolder a(parent_), b(parent_);
  EXPECT_NE(a.path(), b.path());
  EXPECT_TRUE(fs::exists(a.path()));
}

TEST_F(TempFolders, OfADeadProcessAreRemoved) {
  const fs::path abandoned = make("pointsweep-" + std::to_string(pid_of_a_dead_process()) + "-abc123");
  const TempFolder folder(parent_);
  EXPECT_FALSE(fs::exists(abandoned));
}

TEST_F(TempFolders, OfALivingProcessAndOfOthersStay) {
  const std::string dead = std::to_string(pid_of_a_dead_process());
  const fs::path others[] = {make("pointsweep-" + std::to_string(::getppid()) + "-abc123"), make("pointsweep-" + dead),
                             make("pointsweep-" + dead + "-results"), make("pointsweep--1-abc123"),
                             make("data-" + dead + "-abc123")};
  const TempFolder folder(parent_);
  for (const fs::path& other : others) EXPECT_TRUE(fs::exists(other / "spilled")) << other;
}

TEST_F(TempFolders, WithoutAParentAreRefusedWithARemedy) {
  try {
    const TempFolder folder(parent_ / "missing");
    FAIL() << "no folder can be made there";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find((parent_ / "missing").string()), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--temp-dir"), std::string::npos);
  }
}

}  // namespace
}  // namespace pointsweep
