// SPDX-License-Identifier: MIT
/// What `info` keeps of a file that it has looked at, to compare it with the others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "cli/file_summary.h"
#include "pointsweep/geometry.h"
#include "pointsweep/reader.h"

namespace pointsweep {

struct FileRow {
  FileInfo info;  ///< without the extras
  Box bounds;     ///< of the finite points
  std::uint64_t nonfinite = 0;
  double area = 0;  ///< as FileSummary::area
  std::optional<double> density;
  bool is_readable = true;  ///< if not, all but `info.path` is unknown

  FileRow(const FileInfo& about, const FileSummary& summary)
      : info(about),
        bounds(summary.bounds),
        nonfinite(summary.nonfinite),
        area(summary.area),
        density(summary.density(about.count)) {
    info.extras = nullptr;
  }
  explicit FileRow(const std::filesystem::path& unreadable) : is_readable(false) { info.path = unreadable; }
};

}  // namespace pointsweep
