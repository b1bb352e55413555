// SPDX-License-Identifier: MIT
/// Opens an input of a fuzzer as a file in memory, and reads all its rows in order, and again from several rows on.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/formats/chosen_chunks.h"
#include "pointsweep/reader.h"

namespace pointsweep {

/// A file in memory, which exists as long as this object.
class MemoryFile {
 public:
  MemoryFile(const std::uint8_t* bytes, std::size_t size) : descriptor_(::memfd_create("input", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || ::write(descriptor_, bytes, size) != static_cast<ssize_t>(size)) std::abort();
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

/// Opens and reads a file. An Error is a valid answer. Findings are other exceptions, crashes, hangs, a count of points
/// for which the file has no bytes, and reads of other than the counted points. Compressed points may take less than a
/// byte each; only the first 100,000 of them are read.
inline void read_everything(std::unique_ptr<Reader> (*open)(const std::filesystem::path&), const std::uint8_t* bytes,
                            std::size_t size) {
  const MemoryFile file(bytes, size);
  try {
    const auto reader = open(file.path());
    const FileInfo& info = reader->info();
    const bool compressed = info.format.starts_with("LAZ") || info.format.starts_with("E57");
    const std::uint64_t most = compressed ? 100'000 : size;
    if (!compressed && info.count > size) std::abort();
    std::vector<std::byte> records(100 * std::size_t{info.schema.stride});
    std::uint64_t rows = 0;
    while (rows <= most) {
      const std::size_t got = reader->read(rows, records);
      if (got == 0) break;
      rows += got;
    }
    if (rows != info.count && rows <= most) std::abort();
    for (const std::uint64_t row : {rows / 2, rows / 3, rows}) reader->read(row, records);
    if (!info.root_spacing) return;
    const auto coarsest = with_chosen_levels(open(file.path()), "depth:0");
    for (std::uint64_t row = 0; row < std::min(coarsest->info().count, most); row += 100) coarsest->read(row, records);
  } catch (const Error&) {
  }
}

}  // namespace pointsweep
