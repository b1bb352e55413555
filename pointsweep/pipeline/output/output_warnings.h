// SPDX-License-Identifier: MIT
/// The warnings of the writers of many files, without repetition.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pointsweep {

/// Joins warnings that differ only in the file name at their beginning.
class OutputWarnings {
 public:
  void add(const std::vector<std::string>& warnings, const std::filesystem::path& output);
  /// Returns each distinct warning with the name of one file and the number of other files that share it.
  std::vector<std::string> sentences() const;

 private:
  struct Warning {
    std::string first;
    std::size_t others = 0;
  };
  std::map<std::string, Warning> warnings_;  ///< keys: texts after the name of the file
};

}  // namespace pointsweep
