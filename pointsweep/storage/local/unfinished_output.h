// SPDX-License-Identifier: MIT
/// Files of outputs that are not complete. A process that a signal stops removes its own files; files of killed
/// processes are removed by later processes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pointsweep {

/// An entry in the list of files and empty folders that remove_leftovers() (program/process.h) removes when a signal
/// stops the process. The destructor takes the entry off the list and removes no file. A file must be listed before it
/// is made, since the process may be stopped in between. At most 64 paths are listed at once; further paths, and paths
/// of 4,096 characters or more, are ignored.
class Leftover {
 public:
  Leftover() = default;
  explicit Leftover(const std::filesystem::path& path);
  ~Leftover() { forget(); }
  Leftover(const Leftover&) = delete;
  Leftover& operator=(const Leftover&) = delete;
  /// Takes the path off the list, after the file was removed or has become a complete output.
  void forget() noexcept;

 private:
  std::size_t place_ = kNone;
  static constexpr std::size_t kNone = ~std::size_t{0};
};

/// Returns the folder of a file; "." if the path has none.
std::filesystem::path folder_of(const std::filesystem::path& file);
/// Returns the target of the symbolic link `destination`, or `destination` itself if it is not a link or leads to no
/// file.
std::filesystem::path target_of(const std::filesystem::path& destination);
/// Returns `.<name>.<pid>.part` beside `target`: the file of an output of this process until it is complete.
std::filesystem::path part_of(const std::filesystem::path& target);

/// Removes incomplete files of `target` that killed processes have left. Lists the folder of `target`, unless a
/// ManyOutputs has listed it.
void remove_abandoned_parts(const std::filesystem::path& target);

/// The outputs of a run that writes many files into folders. Lists each folder once, and removes the files that killed
/// processes have left of any of the outputs. During its lifetime, remove_abandoned_parts() for one of the outputs is a
/// no-op. Memory: 8 bytes for each output.
class ManyOutputs {
 public:
  /// Lists the folders of the outputs, except for outputs that another ManyOutputs already has. destination(i) returns
  /// the path of output i < `count`.
  ManyOutputs(std::size_t count, const std::function<std::filesystem::path(std::size_t i)>& destination);
  /// Returns the outputs without listing their folders, for a process whose caller lists the folders for many
  /// processes.
  static ManyOutputs listed_by_caller(const std::vector<std::filesystem::path>& destinations);
  ~ManyOutputs();
  ManyOutputs(const ManyOutputs&) = delete;
  ManyOutputs& operator=(const ManyOutputs&) = delete;

  /// Returns whether the file of this name in the folder is the target of an output. Names are compared by hashes, so
  /// an error has a probability of 2^-64 per pair.
  bool has(const std::filesystem::path& folder, const std::string& name) const;

 private:
  /// Adds this object to the list of all ManyOutputs. `targets`: hashes, ascending.
  explicit ManyOutputs(std::vector<std::size_t> targets);

  std::vector<std::size_t> targets_;  ///< hashes of the paths of all outputs, ascending
};

}  // namespace pointsweep
