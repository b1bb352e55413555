// SPDX-License-Identifier: MIT
/// Comparison of encoded values with bytes that a test writes by hand.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

/// Returns the bytes that `text` describes: words of hexadecimal digits, and 'words' in quotation marks for the bytes
/// of their characters.
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

/// Damages bytes 2,000 times: changes bytes and whole numbers in random places, drops parts and repeats parts. Expects
/// that `again` throws an Error or returns the encoding of another value.
inline void expect_survives_damage(const std::vector<std::byte>& bytes,
                                   const std::function<std::vector<std::byte>(std::span<const std::byte>)>& again) {
  constexpr std::array<std::uint64_t, 7> kNumbers = {0, 1, 255, 1u << 31, 1ull << 40, 1ull << 63, ~0ull};
  std::mt19937_64 random(bytes.size());
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % std::max<std::size_t>(1, n)); };
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> damaged = bytes;
    for (std::size_t times = 1 + below(3); times > 0; --times) {
      const std::size_t at = below(damaged.size()), length = below(std::min<std::size_t>(damaged.size() - at, 64));
      const auto place = damaged.begin() + static_cast<std::ptrdiff_t>(at);
      const std::vector<std::byte> part(place, place + static_cast<std::ptrdiff_t>(length));
      switch (below(4)) {
        case 0:
          *place = static_cast<std::byte>(random());
          break;
        case 1:
          std::memcpy(&*place, &kNumbers[below(kNumbers.size())], std::min<std::size_t>(8, damaged.size() - at));
          break;
        case 2:
          damaged.erase(place, place + static_cast<std::ptrdiff_t>(length));
          break;
        default:
          damaged.insert(place, part.begin(), part.end());
      }
    }
    try {
      again(damaged);
    } catch (const Error&) {
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << " of " << hex(damaged);
      return;
    }
  }
}

/// Expects that `bytes`, which encode a value, equal written(by_hand). `again` decodes a value and returns its
/// encoding: expects that it returns `bytes` for `bytes`, throws Error if bytes are missing at the end, follow the end,
/// or state another kind or version, and that it survives damaged bytes.
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
  expect_survives_damage(bytes, again);
}

template <class T>
void expect_encoding(const T& value, const std::string& by_hand) {
  expect_encoding(encoded(value), by_hand,
                  [](std::span<const std::byte> bytes) { return encoded<const T>(decoded<T>(bytes)); });
}

}  // namespace pointsweep
