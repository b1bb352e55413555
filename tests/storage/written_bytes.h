// SPDX-License-Identifier: MIT
/// Encoded values beside their bytes as a test writes them.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// Returns the bytes of words in hexadecimal digits and of 'words' in quotation marks, which stand for their
/// characters.
inline std::vector<std::byte> written(const std::string& text) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == ' ' || text[i] == '\n') {
      ++i;
    } else if (text[i] == '\'') {
      for (++i; text[i] != '\''; ++i) bytes.push_back(static_cast<std::byte>(text[i]));
      ++i;
    } else {
      bytes.push_back(static_cast<std::byte>(std::stoi(text.substr(i, 2), nullptr, 16)));
      i += 2;
    }
  }
  return bytes;
}

inline std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte b : bytes) text += fmt::format("{:02x}", static_cast<unsigned>(b));
  return text;
}

/// Expects that `bytes`, which encode a value, are those of written(by_hand), and that `again`, which decodes a value
/// and returns its bytes, gives the same value back; and refuses all bytes that are cut short, all that go on after
/// their end, another kind and another version.
inline void expect_encoding(const std::vector<std::byte>& bytes, const std::string& by_hand,
                            const std::function<std::vector<std::byte>(std::span<const std::byte>)>& again) {
  ASSERT_EQ(hex(bytes), hex(written(by_hand)));
  EXPECT_EQ(hex(again(bytes)), hex(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(again(std::span(bytes).first(size)), Error) << "of " << size << " bytes";
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_THROW(again(longer), Error);
  const std::size_t version = 1 + static_cast<std::size_t>(bytes[0]);
  for (const std::size_t changed : {std::size_t{1}, version}) {
    std::vector<std::byte> other = bytes;
    other[changed] ^= std::byte{64};
    EXPECT_THROW(again(other), Error);
  }
}

template <class T>
void expect_encoding(const T& value, const std::string& by_hand) {
  expect_encoding(encoded(value), by_hand,
                  [](std::span<const std::byte> bytes) { return encoded<const T>(decoded<T>(bytes)); });
}

}  // namespace pointsweep
