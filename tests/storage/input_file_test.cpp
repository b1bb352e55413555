// SPDX-License-Identifier: MIT
#include "pointsweep/storage/local/input_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>

#include "pointsweep/error.h"
#include "tests/formats/temporary_folder.h"

namespace pointsweep {
namespace {

using ::testing::HasSubstr;

TEST(InputFile, ReadsAtAnyPlaceUpToTheEnd) {
  const TemporaryFolder folder;
  const InputFile file(folder.write("in", "0123456789"));
  std::array<char, 4> text{};
  file.read_at(3, std::as_writable_bytes(std::span(text)));
  EXPECT_EQ(std::string_view(text.data(), 4), "3456");
  EXPECT_EQ(file.size(), 10u);
  EXPECT_EQ(file.read_some(8, std::as_writable_bytes(std::span(text))), 2u);
  EXPECT_EQ(file.read_some(20, std::as_writable_bytes(std::span(text))), 0u);
}

TEST(InputFile, NoticesThatTheFileHasBecomeShorter) {
  const TemporaryFolder folder;
  const InputFile file(folder.write("in", "0123456789"));
  std::filesystem::resize_file(folder / "in", 5);
  std::array<char, 4> text{};
  EXPECT_THAT(sentence_of<Error>([&] { file.read_at(4, std::as_writable_bytes(std::span(text))); }),
              HasSubstr("ends before byte 8; it has become shorter"));
}

TEST(InputFile, SaysWhyAFileCannotBeOpened) {
  const TemporaryFolder folder;
  EXPECT_THAT(sentence_of<Error>([&] { InputFile(folder / "missing"); }), HasSubstr("no such file"));
  EXPECT_THAT(sentence_of<Error>([&] { InputFile(folder.path()); }), HasSubstr("is a folder"));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(sentence_of<Error>([&] { InputFile(folder / "pipe"); }), HasSubstr("is no regular file"));
  if (::geteuid() != 0) {
    std::filesystem::permissions(folder.write("secret", "x"), std::filesystem::perms::none);
    EXPECT_THAT(sentence_of<Error>([&] { InputFile(folder / "secret"); }), HasSubstr("no permission to read"));
  }
}

TEST(InputFile, SaysThatTooManyFilesAreOpen) {
  const TemporaryFolder folder;
  const auto path = folder.write("in", "x");
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &old), 0);
  const rlimit none{0, old.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::string sentence = sentence_of<Error>([&] { InputFile{path}; });
  ::setrlimit(RLIMIT_NOFILE, &old);
  EXPECT_THAT(sentence, HasSubstr("too many files are open; allow more first"));
}

}  // namespace
}  // namespace pointsweep
