// SPDX-License-Identifier: MIT
#include "pointsweep/storage/encoding.h"

#include <algorithm>
#include <cassert>

#include "pointsweep/fail.h"

namespace pointsweep {

void Encoder::begin(Encoding encoding) {
  assert(encoding.kind.size() < 256);
  put<std::uint8_t>(static_cast<std::uint8_t>(encoding.kind.size()));
  append(std::as_bytes(std::span(encoding.kind)));
  put<std::uint16_t>(encoding.version);
}

void Encoder::put_text(std::string_view text) { put_bytes(std::as_bytes(std::span(text))); }

void Encoder::put_bytes(std::span<const std::byte> bytes) {
  put<std::uint64_t>(bytes.size());
  append(bytes);
}

void Decoder::begin(Encoding expected) {
  if (!outermost_) outermost_ = expected;
  const std::span<const std::byte> bytes = take(get<std::uint8_t>());
  const std::string kind(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto version = get<std::uint16_t>();
  if (kind != expected.kind || version != expected.version)
    refuse(fmt::format("hold '{}' of version {} where '{}' of version {} is expected", kind, version, expected.kind,
                       expected.version));
}

bool Decoder::get_bool() {
  const auto value = get<std::uint8_t>();
  if (value > 1) refuse(fmt::format("hold {} for a truth value", value));
  return value == 1;
}

std::string Decoder::get_text() {
  const std::span<const std::byte> bytes = take(get_count());
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> Decoder::get_bytes() {
  const std::span<const std::byte> bytes = take(get_count());
  return {bytes.begin(), bytes.end()};
}

void Decoder::get_bytes(std::span<std::byte> to) {
  const std::span<const std::byte> bytes = take(get_count());
  if (bytes.size() != to.size()) refuse(fmt::format("hold {} bytes where {} are expected", bytes.size(), to.size()));
  std::ranges::copy(bytes, to.begin());
}

void Decoder::finish() const {
  if (!rest_.empty()) refuse(fmt::format("go on for {} bytes after its end", rest_.size()));
}

std::uint64_t Decoder::get_count() {
  const auto count = get<std::uint64_t>();
  if (count > rest_.size()) refuse("end too early");  // a damaged count must not make the caller reserve memory
  return count;
}

std::span<const std::byte> Decoder::take(std::uint64_t size) {
  if (size > rest_.size()) refuse("end too early");
  const std::span<const std::byte> taken = rest_.first(size);
  rest_ = rest_.subspan(size);
  return taken;
}

void Decoder::refuse(const std::string& why) const {
  fail("The bytes of an encoded '{}' {}: they are damaged, or another version of pointsweep has made them.",
       outermost_ ? outermost_->kind : "value", why);
}

}  // namespace pointsweep
