// SPDX-License-Identifier: MIT
#include "pointsweep/points/text_file.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMostBytes = 256u << 20;

}  // namespace

std::string read_text_file(const std::string& path, std::string_view holds) {
  if (std::error_code error; std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
    fail("{}: is no file; give one with {}.", path, holds);
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) fail("{}: cannot be opened; give a file with {}.", path, holds);
  const auto bytes = static_cast<std::streamoff>(file.tellg());
  if (bytes < 0) fail("{}: cannot be read; give a file with {}.", path, holds);
  if (static_cast<std::uint64_t>(bytes) > kMostBytes)
    fail("{}: is larger than 256 MB, too much for a file with {}.", path, holds);
  std::string text(static_cast<std::size_t>(bytes), '\0');
  file.seekg(0);
  if (!file.read(text.data(), bytes)) fail("{}: cannot be read; check its permissions.", path);
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

std::string checksum_of_text(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

}  // namespace pointsweep
