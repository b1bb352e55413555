// SPDX-License-Identifier: MIT
/// Copies a point file in its own order with the library's readers and writers. With --plain, copies its bytes, 4 MB at
/// a time.
///   copy_points [--plain] IN OUT
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/records/write_behind.h"
#include "pointsweep/threads.h"
#include "pointsweep/writer.h"

namespace {

constexpr std::size_t kBlock = std::size_t{4} << 20;

/// Copies points with two threads: one reads, the other writes.
void copy_points(const std::string& in, const std::string& out) {
  using namespace pointsweep;
  InputCloud cloud({in});
  WriteBehind files;
  files.add(create_writer(
      {.path = out, .schema = cloud.schema(), .count = cloud.count(), .extras = cloud.extras(), .overwrite = true}));
  const std::size_t stride = cloud.schema().stride, in_block = std::max<std::size_t>(1, kBlock / stride);
  with_threads(2, [&] {
    std::vector<std::byte> records;
    for (std::uint64_t row = 0; row < cloud.count();) {
      records.resize(in_block * stride);
      const std::size_t n = cloud.read(row, records);
      records.resize(n * stride);
      files.write(records);
      row += n;
    }
    files.finish();
  });
}

struct Descriptor {
  int number;
  Descriptor(const std::string& path, int flags) : number(open(path.c_str(), flags, 0666)) {
    if (number < 0) throw std::runtime_error(path + ": cannot open");
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(number); }
};

void copy_bytes(const std::string& in, const std::string& out) {
  const Descriptor from(in, O_RDONLY), to(out, O_WRONLY | O_CREAT | O_TRUNC);
  std::vector<char> block(kBlock);
  for (ssize_t n; (n = read(from.number, block.data(), block.size())) != 0;) {
    if (n < 0) throw std::runtime_error(in + ": cannot read");
    for (ssize_t done = 0, more; done < n; done += more)
      if ((more = write(to.number, block.data() + done, std::size_t(n - done))) <= 0)
        throw std::runtime_error(out + ": cannot write");
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const bool plain = argc == 4 && std::string(argv[1]) == "--plain";
  if (argc != 3 && !plain) return std::fprintf(stderr, "usage: %s [--plain] IN OUT\n", argv[0]), 2;
  plain ? copy_bytes(argv[2], argv[3]) : copy_points(argv[1], argv[2]);
} catch (const std::exception& error) {
  return std::fprintf(stderr, "%s\n", error.what()), 1;
}
