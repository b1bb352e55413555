// SPDX-License-Identifier: MIT
/// The warnings of the writers of many files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pointsweep {

/// Joins warnings that differ only in the name of the file, with which they begin.
class OutputWarnings {
 public:
  void add(const std::vector<std::string>& warnings, const std::filesystem::path& output);
  /// Returns a sentence for each thing that a file cannot hold, with the number of other files that share it.
  std::vector<std::string> sentences() const;

 private:
  struct Warning {
    std::string first;
    std::size_t others = 0;
  };
  std::map<std::string, Warning> warnings_;  ///< by what follows the name of the file
};

}  // namespace pointsweep
