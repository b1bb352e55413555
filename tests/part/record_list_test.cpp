// SPDX-License-Identifier: MIT
/// Lists of records that are objects.
#include "pointsweep/part/record_list.h"

#include <gtest/gtest.h>

#include <cstring>
#include <numeric>
#include <vector>

#include "pointsweep/error.h"
#include "tests/support/memory_storage.h"

namespace pointsweep {
namespace {

using Numbers = std::vector<std::uint32_t>;

Numbers numbers_up_to(std::size_t count) {
  Numbers numbers(count);
  std::iota(numbers.begin(), numbers.end(), 7u);
  return numbers;
}

void write(Storage& storage, const Numbers& numbers, std::size_t at_once) {
  RecordListWriter list(storage, "list", sizeof(std::uint32_t));
  for (std::size_t first = 0; first < numbers.size(); first += at_once)
    list.append(std::as_bytes(std::span(numbers).subspan(first, std::min(at_once, numbers.size() - first))));
  EXPECT_EQ(list.count(), numbers.size());
  list.seal();
}

TEST(RecordLists, AreReadAtAnyPlaceHoweverTheyWereWritten) {
  for (const std::size_t count : {0u, 1u, 1023u, 1024u, 1025u, 5000u}) {
    for (const std::size_t at_once : {1u, 700u, 4096u}) {
      MemoryStorage storage;
      const Numbers numbers = numbers_up_to(count);
      write(storage, numbers, at_once);
      RecordList list(storage, "list", sizeof(std::uint32_t));
      ASSERT_EQ(list.count(), count);
      for (const std::size_t first : {0u, 5u, 1000u, 1024u, 2047u, 4999u}) {
        if (first >= count) continue;
        Numbers found(std::min<std::size_t>(count - first, 2100));
        list.read(first, std::as_writable_bytes(std::span(found)));
        EXPECT_TRUE(std::equal(found.begin(), found.end(), numbers.begin() + static_cast<std::ptrdiff_t>(first)));
      }
      std::uint32_t beyond;
      EXPECT_THROW(list.read(count, std::as_writable_bytes(std::span(&beyond, 1))), Error);
    }
  }
}

TEST(RecordLists, ThatAreDamagedAnywhereAreRefused) {
  const Numbers numbers = numbers_up_to(2000);
  const auto all_of = [&](Storage& storage) {
    RecordList list(storage, "list", sizeof(std::uint32_t));
    Numbers found(list.count());
    list.read(0, std::as_writable_bytes(std::span(found)));
    return found;
  };
  MemoryStorage whole;
  write(whole, numbers, 2000);
  EXPECT_EQ(all_of(whole), numbers);
  std::vector<std::byte> bytes(whole.open("list")->size());
  whole.open("list")->read_at(0, bytes);
  for (std::size_t at = 0; at < bytes.size(); at += 97) {
    std::vector<std::byte> damaged = bytes;
    damaged[at] ^= std::byte{4};
    MemoryStorage storage;
    const auto object = storage.create("list");
    object->append(damaged);
    object->seal();
    EXPECT_THROW(all_of(storage), Error) << at;
  }
  for (const std::size_t size : {1u, 8u, 13u, 4100u, 4104u, 4105u}) {
    MemoryStorage storage;
    const auto object = storage.create("list");
    object->append(std::span(bytes).first(size));
    object->seal();
    try {
      EXPECT_NE(all_of(storage), numbers);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("list: is damaged."), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace pointsweep
