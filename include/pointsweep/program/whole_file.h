// SPDX-License-Identifier: MIT
/// A small file of a program, such as a report, that appears complete or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "pointsweep/export.h"

namespace pointsweep {

class OutputFile;

/// A file that is written beside its destination, or uploaded to a URL, and renamed when it is complete; otherwise the
/// destructor removes it. "-" is standard output. Every failure is an Error that names the destination and says what to
/// do (no space left, folder missing, read-only).
class POINTSWEEP_EXPORT WholeFile {
 public:
  /// Throws before anything is written if the destination exists and `overwrite` is false, if it is a folder, or if its
  /// folder is missing. A program makes the object before its work, so that a bad name costs no time.
  WholeFile(const std::filesystem::path& destination, bool overwrite);
  ~WholeFile();

  /// Writes the content and completes the file. Called once.
  void complete(std::span<const std::byte> content);
  void complete(std::string_view content);

 private:
  std::unique_ptr<OutputFile> file_;
};

}  // namespace pointsweep
