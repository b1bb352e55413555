// SPDX-License-Identifier: MIT
#include "pointsweep/storage/storage.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

namespace pointsweep {
namespace {

constexpr std::string_view kMagic = "PSWCKPT2";
constexpr std::size_t kHeadBytes = kMagic.size() + 2 * sizeof(std::uint64_t);

std::vector<std::byte> head_of(std::span<const std::byte> bytes) {
  Encoder head;
  for (const char c : kMagic) head.put<std::uint8_t>(static_cast<std::uint8_t>(c));
  head.put<std::uint64_t>(bytes.size());
  head.put<std::uint64_t>(checksum_of(bytes));
  return head.take();
}

}  // namespace

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  const auto mixed = [](std::uint64_t sum, std::uint64_t word) {
    sum = (sum ^ word) * 0x100000001b3;
    return sum ^ sum >> 32;
  };
  static_assert(std::endian::native == std::endian::little, "the words are little-endian");
  const auto word_at = [&](std::size_t at, std::size_t count) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, count);
    return word;
  };
  // The four sums do not wait for each other, so that a processor computes them at once.
  std::array<std::uint64_t, 4> sums{0xcbf29ce484222325, 1, 2, 3};
  std::size_t at = 0;
  for (; at + 8 * sums.size() <= bytes.size(); at += 8 * sums.size())
    for (std::size_t lane = 0; lane < sums.size(); ++lane) sums[lane] = mixed(sums[lane], word_at(at + 8 * lane, 8));
  std::uint64_t sum = bytes.size();
  for (const std::uint64_t lane : sums) sum = mixed(sum, lane);
  for (; at < bytes.size(); at += 8) sum = mixed(sum, word_at(at, std::min<std::size_t>(8, bytes.size() - at)));
  return sum;
}

void seal_bytes(Storage& storage, const std::string& key, std::span<const std::byte> bytes) {
  const std::unique_ptr<Unsealed> object = storage.create(key);
  object->append(head_of(bytes));
  object->append(bytes);
  object->seal();
}

std::vector<std::byte> sealed_identity(const Storage& storage, const std::string& key) {
  const std::unique_ptr<Source> object = storage.open(key);
  if (object->size() < kHeadBytes) return {};
  std::vector<std::byte> head(kHeadBytes);
  object->read_at(0, head);
  return head;
}

std::optional<std::vector<std::byte>> sealed_bytes(const Storage& storage, const std::string& key) {
  const std::unique_ptr<Source> object = storage.open(key);
  if (object->size() < kHeadBytes) return {};
  std::vector<std::byte> head(kHeadBytes), bytes(object->size() - kHeadBytes);
  object->read_at(0, head);
  object->read_at(kHeadBytes, bytes);
  if (head != head_of(bytes)) return {};
  return bytes;
}

}  // namespace pointsweep
