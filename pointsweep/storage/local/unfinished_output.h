// SPDX-License-Identifier: MIT
/// Outputs that are not complete: where they are, and what becomes of those whose process was killed.
#pragma once

#include <filesystem>
#include <vector>

namespace pointsweep {

/// The folder of a file; "." where the path names none.
std::filesystem::path folder_of(const std::filesystem::path& file);
/// Returns the target of the link `destination`, or `destination` itself if it is no link.
std::filesystem::path target_of(const std::filesystem::path& destination);
/// `.<name>.<pid>.part` beside `target`: an output of this process until it is complete.
std::filesystem::path part_of(const std::filesystem::path& target);

/// Removes what killed processes have left of `target`. Lists its folder, unless ManyOutputs has done so.
void remove_abandoned_parts(const std::filesystem::path& target);

/// The outputs of a run that writes many files into a folder. Lists each folder once, and removes what killed processes
/// have left of any of the outputs. While it lives, remove_abandoned_parts() of one of them does nothing.
class ManyOutputs {
 public:
  explicit ManyOutputs(const std::vector<std::filesystem::path>& destinations);
  ~ManyOutputs();
  ManyOutputs(const ManyOutputs&) = delete;
  ManyOutputs& operator=(const ManyOutputs&) = delete;

 private:
  std::vector<std::filesystem::path> targets_;
};

}  // namespace pointsweep
