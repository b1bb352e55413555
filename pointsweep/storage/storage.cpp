// SPDX-License-Identifier: MIT
#include "pointsweep/storage/storage.h"

#include <algorithm>
#include <string_view>

#include "pointsweep/storage/encoding.h"

namespace pointsweep {
namespace {

constexpr std::string_view kMagic = "PSWCKPT1";
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
  std::uint64_t sum = 0xcbf29ce484222325;
  const auto add = [&sum](std::uint64_t word) {
    sum = (sum ^ word) * 0x100000001b3;
    sum ^= sum >> 32;
  };
  std::size_t at = 0;
  for (; at + 8 <= bytes.size(); at += 8) {
    std::uint64_t word = 0;
    for (std::size_t i = 0; i < 8; ++i) word |= std::to_integer<std::uint64_t>(bytes[at + i]) << 8 * i;
    add(word);
  }
  std::uint64_t last = 0;
  for (std::size_t i = 0; at + i < bytes.size(); ++i) last |= std::to_integer<std::uint64_t>(bytes[at + i]) << 8 * i;
  if (at < bytes.size()) add(last);
  return sum;
}

void seal_bytes(Storage& storage, const std::string& key, std::span<const std::byte> bytes) {
  const std::unique_ptr<Unsealed> object = storage.create(key);
  object->append(head_of(bytes));
  object->append(bytes);
  object->seal();
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
