// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/output_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "pointsweep/error.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using ::testing::HasSubstr;

std::ptrdiff_t files_in(const std::filesystem::path& folder) {
  return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  {
    OutputFile file(folder / "out", false);
    file.append(text_bytes("hello "));
    file.append(text_bytes("world"));
    EXPECT_EQ(file.size(), 11u);
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    file.seal();
  }
  EXPECT_EQ(contents(folder / "out"), "hello world");
  EXPECT_EQ(files_in(folder.path()), 1);
}

TEST(OutputFile, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  { OutputFile(folder / "out", false).append(text_bytes("half")); }
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(OutputFile, WritesAtAnyPlace) {
  const TemporaryFolder folder;
  OutputFile file(folder / "out", false);
  file.write_at(3, text_bytes("def"));
  file.write_at(0, text_bytes("abc"));
  file.seal();
  EXPECT_EQ(contents(folder / "out"), "abcdef");
}

TEST(OutputFile, RefusesAnExistingFileUnlessToldToReplaceIt) {
  const TemporaryFolder folder;
  const auto path = folder.write("out", "old");
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile(path, false); }), HasSubstr("exists already"));
  OutputFile file(path, true);
  file.append(text_bytes("new"));
  EXPECT_EQ(contents(path), "old");
  file.seal();
  EXPECT_EQ(contents(path), "new");
}

TEST(OutputFile, DoesNotReplaceAFileThatAppearedMeanwhile) {
  const TemporaryFolder folder;
  {
    OutputFile file(folder / "out", false);
    folder.write("out", "somebody else's");
    EXPECT_THAT(sentence_of<Error>([&] { file.seal(); }), HasSubstr("exists already"));
  }
  EXPECT_EQ(contents(folder / "out"), "somebody else's");
  EXPECT_EQ(files_in(folder.path()), 1);
}

TEST(OutputFile, ReplacesWhatALinkPointsTo) {
  const TemporaryFolder folder;
  const auto target = folder.write("target", "old");
  std::filesystem::create_symlink(target, folder / "link");
  OutputFile file(folder / "link", true);
  file.append(text_bytes("new"));
  file.seal();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(contents(target), "new");
}

TEST(OutputFile, SaysWhatIsWrongWithTheDestination) {
  const TemporaryFolder folder;
  folder.write("file", "");
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile(folder / "missing/out", false); }),
              HasSubstr("missing does not exist; create it first"));
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile(folder.path(), true); }), HasSubstr("is a folder"));
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile(folder / "file/out", false); }), HasSubstr("is no folder"));
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile("", false); }), HasSubstr("names no file"));
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile("/dev/full", true); }), HasSubstr("is no regular file"));
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile(folder / std::string(300, 'n'), false); }), HasSubstr("too long"));
}

TEST(OutputFile, SaysThatAFolderIsReadOnly) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile(folder / "out", false); }), HasSubstr("no permission to write in"));
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
}

TEST(OutputFile, RunningOutOfRoomIsAnErrorAndLeavesNothing) {
  const TemporaryFolder folder;
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, old.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string sentence;
  {
    OutputFile file(folder / "out", false);
    const std::string block(3000, 'a');
    sentence = sentence_of<Error>([&] {
      for (int i = 0; i < 3; ++i) file.append(text_bytes(block));
    });
  }
  ::setrlimit(RLIMIT_FSIZE, &old);
  ::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(sentence, HasSubstr("larger than its file system or a limit"));
  EXPECT_EQ(files_in(folder.path()), 0);
}

TEST(OutputFile, RemovesWhatAKilledRunLeft) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  folder.write(fmt::format(".out.{}.part", child), "half");
  folder.write(fmt::format(".out.{}.part", ::getpid()), "left by an earlier process with our number");
  folder.write(".out.1.part", "of a running process");
  folder.write(fmt::format(".other.{}.part", child), "of another output");
  { OutputFile file(folder / "out", false); }
  EXPECT_FALSE(std::filesystem::exists(folder / fmt::format(".out.{}.part", child)));
  EXPECT_TRUE(std::filesystem::exists(folder / ".out.1.part"));
  EXPECT_EQ(files_in(folder.path()), 2);
}

TEST(ManyOutputs, RemoveOnceWhatAKilledRunLeftAndTheirFilesDoNotLookForMore) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "b");
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  const auto left = [&](const std::string& output) {
    const std::filesystem::path path = folder / output;
    return path.parent_path() / fmt::format(".{}.{}.part", path.filename().string(), child);
  };
  const auto is_left = [&](const std::string& output) { return std::filesystem::exists(left(output)); };
  for (const char* output : {"one", "b/two", "b/other"}) std::ofstream(left(output)) << "half";
  {
    const std::vector<std::filesystem::path> files = {folder / "one", folder / "b/two", folder / "b/three.las"};
    const ManyOutputs outputs(files.size(), [&](std::size_t i) { return files[i]; });
    EXPECT_FALSE(is_left("one"));
    EXPECT_FALSE(is_left("b/two"));
    EXPECT_TRUE(is_left("b/other"));
    std::ofstream(left("b/three.las")) << "half";
    { OutputFile file(folder / "b/three.las", false); }
    EXPECT_TRUE(is_left("b/three.las"));
  }
  { OutputFile file(folder / "b/three.las", false); }
  EXPECT_FALSE(is_left("b/three.las"));
}

TEST(OutputFile, IsNotTakenFromAWriterThatIsStillAtWork) {
  const TemporaryFolder folder;
  OutputFile first(folder / "out", false);
  first.append(text_bytes("first"));
  EXPECT_THAT(sentence_of<Error>([&] { OutputFile(folder / "out", false); }), HasSubstr("is being written already"));
  first.seal();
  EXPECT_EQ(contents(folder / "out"), "first");
}

}  // namespace
}  // namespace pointsweep
