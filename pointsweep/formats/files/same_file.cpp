// SPDX-License-Identifier: MIT
#include "pointsweep/formats/files/same_file.h"

#include <sys/stat.h>

#include <string>
#include <system_error>

#include "pointsweep/fail.h"
#include "pointsweep/formats/files/standard_streams.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

bool have_same_inode(const fs::path& a, const fs::path& b) {
  struct stat of_a {
  }, of_b{};
  if (::stat(a.c_str(), &of_a) != 0 || ::stat(b.c_str(), &of_b) != 0) return false;
  return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
}

/// Without links, `.` and `..`, as far as the path exists.
fs::path canonical_form(const fs::path& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path.lexically_normal() : canonical;
}

/// "b.las", or "./b.las (b.las)" where the paths are spelled differently.
std::string both_names(const fs::path& named, const fs::path& other) {
  return named == other ? named.string() : fmt::format("{} ({})", named.string(), other.string());
}

}  // namespace

bool lead_to_same_file(const fs::path& a, const fs::path& b) {
  if (is_standard_stream(a) || is_standard_stream(b)) return a == b;
  return have_same_inode(a, b) || canonical_form(a) == canonical_form(b);
}

void require_separate_files(const std::vector<fs::path>& read, const std::vector<fs::path>& written) {
  for (std::size_t w = 0; w < written.size(); ++w) {
    if (written[w].empty()) continue;
    for (const fs::path& input : read)
      if (!input.empty() && !is_standard_stream(input) && lead_to_same_file(written[w], input))
        fail_usage("{}: is an input, and an input is never overwritten; write to another file.",
                   both_names(written[w], input));
    for (std::size_t other = 0; other < w; ++other)
      if (!written[other].empty() && lead_to_same_file(written[w], written[other]))
        fail_usage("{}: is named for two outputs; give each its own file.", both_names(written[w], written[other]));
  }
}

}  // namespace pointsweep
