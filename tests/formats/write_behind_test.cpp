// SPDX-License-Identifier: MIT
#include "pointsweep/formats/records/write_behind.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// The bytes that a writer has received, and whether finish() was called.
struct Arrived {
  std::vector<std::byte> bytes;
  bool finished = false;
};

class Keeper final : public Writer {
 public:
  explicit Keeper(Arrived& to, std::size_t room = 1 << 20) : to_(to), room_(room) {}
  void write(std::span<const std::byte> records) override {
    if (to_.bytes.size() + records.size() > room_) throw std::runtime_error("no space left");
    to_.bytes.insert(to_.bytes.end(), records.begin(), records.end());
    bytes_written_ += records.size();
  }
  void finish() override { to_.finished = true; }

 private:
  Arrived& to_;
  std::size_t room_;
};

std::vector<std::byte> chunk(int number) { return std::vector<std::byte>(100, std::byte(number)); }

TEST(WriteBehind, WritesEverythingInOrderToEveryWriter) {
  for (const unsigned threads : {1u, 3u}) {
    with_threads(threads, [] {
      Arrived a, b;
      WriteBehind files;
      files.add(std::make_unique<Keeper>(a));
      files.add(std::make_unique<Keeper>(b));
      std::vector<std::byte> expected, records;
      for (int i = 0; i < 50; ++i) {
        records = chunk(i);
        expected.insert(expected.end(), records.begin(), records.end());
        files.write(records);
      }
      files.finish();
      EXPECT_EQ(a.bytes, expected);
      EXPECT_EQ(b.bytes, expected);
      EXPECT_TRUE(a.finished && b.finished);
      EXPECT_EQ(files.bytes_written(), 2 * expected.size());
    });
  }
}

TEST(WriteBehind, ThrowsAFailureAtTheNextCallAndCompletesNothing) {
  with_threads(2, [] {
    Arrived a;
    WriteBehind files;
    files.add(std::make_unique<Keeper>(a, 250));
    std::vector<std::byte> records;
    const auto write = [&] { files.write(records = chunk(1)); };
    write(), write(), write();
    EXPECT_THROW(write(), std::runtime_error);
    EXPECT_FALSE(a.finished);
  });
}

TEST(WriteBehind, FinishThrowsWhatTheLastChunkMet) {
  with_threads(2, [] {
    Arrived a;
    WriteBehind waited, last;
    for (WriteBehind* files : {&waited, &last}) {
      std::vector<std::byte> records = chunk(1);
      files->add(std::make_unique<Keeper>(a, 50));
      files->write(records);
    }
    EXPECT_THROW(waited.wait(), std::runtime_error);
    EXPECT_THROW(last.finish(), std::runtime_error);
    EXPECT_FALSE(a.finished);
  });
}

}  // namespace
}  // namespace pointsweep
