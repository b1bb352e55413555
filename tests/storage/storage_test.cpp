// SPDX-License-Identifier: MIT
/// The laws of Storage, in memory, in a folder of one run and in a shared folder.
#include "pointsweep/storage/storage.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/storage/local/folder_storage.h"
#include "tests/formats/temporary_folder.h"
#include "tests/storage/written_bytes.h"
#include "tests/support/memory_storage.h"

namespace pointsweep {
namespace {

std::vector<std::byte> bytes_in(const Storage& storage, const std::string& key) {
  const std::unique_ptr<Source> object = storage.open(key);
  std::vector<std::byte> bytes(object->size());
  object->read_at(0, bytes);
  return bytes;
}

void put(Storage& storage, const std::string& key, const std::string& bytes) {
  const std::unique_ptr<Unsealed> object = storage.create(key);
  object->append(written(bytes));
  object->seal();
}

void for_each_storage(const std::function<void(Storage&)>& test) {
  MemoryStorage memory;
  test(memory);
  const TemporaryFolder folder;
  LocalFolder local(folder / "objects", "an object", "--objects");
  test(local);
  const std::filesystem::path shared = folder / "shared";
  std::filesystem::create_directory(shared);
  test(*shared_storage(shared));
}

TEST(Storage, ShowsAnObjectOnceItIsSealed) {
  for_each_storage([](Storage& storage) {
    const std::unique_ptr<Unsealed> object = storage.create("b");
    object->append(written("01 02"));
    object->append(written("03"));
    object->write_at(1, written("ff"));
    EXPECT_TRUE(storage.list().empty());
    EXPECT_THROW(storage.open("b"), Error);
    object->seal();
    put(storage, "a", "");
    EXPECT_EQ(storage.list(), (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(hex(bytes_in(storage, "b")), "01ff03");
    EXPECT_EQ(bytes_in(storage, "a").size(), 0u);
    std::vector<std::byte> bytes(2);
    storage.open("b")->read_at(1, bytes);
    EXPECT_EQ(hex(bytes), "ff03");
    EXPECT_THROW(storage.open("b")->read_at(2, bytes), Error);
  });
}

TEST(Storage, ReplacesAnObjectAsAWhole) {
  for_each_storage([](Storage& storage) {
    put(storage, "a", "0102030405");
    {
      const std::unique_ptr<Unsealed> object = storage.create("a");
      object->append(written("06"));
      EXPECT_EQ(hex(bytes_in(storage, "a")), "0102030405");
    }
    EXPECT_EQ(hex(bytes_in(storage, "a")), "0102030405");
    const std::unique_ptr<Source> before = storage.open("a");
    put(storage, "a", "07");
    EXPECT_EQ(hex(bytes_in(storage, "a")), "07");
    EXPECT_EQ(before->size(), 5u);  // an open object does not change
    storage.remove("a");
    storage.remove("a");
    EXPECT_TRUE(storage.list().empty());
  });
}

/// Whichever operation fails, the storage holds the whole old object or the whole new object.
TEST(Storage, ThatFailsHoldsWholeObjects) {
  const std::vector<std::byte> before = written("01020304"), after = written("05060708090a");
  for_each_storage([&](Storage& storage) {
    seal_bytes(storage, "a", before);
    bool fails = true;
    for (std::size_t operation = 0; fails; ++operation) {
      FaultyStorage faulty(storage, operation);
      fails = false;
      try {
        seal_bytes(faulty, "a", after);
      } catch (const Error&) {
        fails = true;
      }
      EXPECT_EQ(storage.list(), std::vector<std::string>{"a"});
      EXPECT_EQ(sealed_bytes(storage, "a"), fails ? before : after) << "operation " << operation;
    }
    for (std::size_t operation = 0; operation < 3; ++operation)
      EXPECT_THROW(sealed_bytes(FaultyStorage(storage, operation), "a"), Error);
    EXPECT_EQ(sealed_bytes(FaultyStorage(storage, 3), "a"), after);
  });
}

TEST(Storage, KnowsWhenSealedBytesAreDamaged) {
  MemoryStorage storage;
  seal_bytes(storage, "a", written("0102030405060708 09"));
  const std::vector<std::byte> nine = bytes_in(storage, "a");
  EXPECT_EQ(hex(std::span(nine).first(16)), hex(written("'PSWCKPT2' 0900000000000000")));
  const auto damaged = [&](const std::vector<std::byte>& bytes) {
    put(storage, "b", hex(bytes));
    return !sealed_bytes(storage, "b").has_value();
  };
  for (const std::size_t size : {0, 1, 8, 9, 31, 32, 33, 100, 128}) {
    std::vector<std::byte> value(size);
    for (std::size_t i = 0; i < size; ++i) value[i] = static_cast<std::byte>(i / 8);
    seal_bytes(storage, "a", value);
    const std::vector<std::byte> whole = bytes_in(storage, "a");
    EXPECT_FALSE(damaged(whole));
    for (std::size_t i = 0; i < whole.size(); ++i) {
      std::vector<std::byte> other = whole;
      other[i] ^= std::byte{1};
      EXPECT_TRUE(damaged(other)) << size << ' ' << i;
      EXPECT_TRUE(damaged({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(i)})) << size << ' ' << i;
    }
    for (std::size_t word = 0; size == 128 && word + 1 < size / 8; ++word) {
      std::vector<std::byte> other = whole;
      std::swap_ranges(other.end() - static_cast<std::ptrdiff_t>(size - 8 * word),
                       other.end() - static_cast<std::ptrdiff_t>(size - 8 * word - 8),
                       other.end() - static_cast<std::ptrdiff_t>(size - 8 * word - 8));
      EXPECT_TRUE(damaged(other)) << "words " << word << " and the next are exchanged";
    }
  }
}

TEST(LocalFolder, IsOfOneProcess) {
  const TemporaryFolder folder;
  const LocalFolder local(folder / "objects", "an object", "--objects");
  try {
    const LocalFolder other(folder / "objects", "an object", "--objects");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("another run is working in"), std::string::npos);
  }
}

TEST(LocalFolder, HidesWhatAKilledProcessHasLeft) {
  const TemporaryFolder folder;
  LocalFolder local(folder / "objects", "an object", "--objects");
  put(local, "a", "01");
  std::filesystem::copy_file(folder / "objects" / "a", folder / "objects" / "a.unsealed");
  EXPECT_EQ(local.list(), std::vector<std::string>{"a"});
  std::filesystem::copy_file(folder / "objects" / "a", folder / "objects" / "scan.new");
  EXPECT_EQ(local.list(), (std::vector<std::string>{"a", "scan.new"})) << "a file of the user";
  std::filesystem::remove(folder / "objects" / "scan.new");
  put(local, "a", "02");
  EXPECT_EQ(hex(bytes_in(local, "a")), "02");
  local.remove("a");
  local.remove_folder();
  EXPECT_FALSE(std::filesystem::exists(folder / "objects"));
}

}  // namespace
}  // namespace pointsweep
