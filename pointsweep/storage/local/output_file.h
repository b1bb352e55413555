// SPDX-License-Identifier: MIT
/// An output: a file, or an object in the network, that appears complete or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "pointsweep/storage/local/descriptor.h"
#include "pointsweep/storage/local/unfinished_output.h"
#include "pointsweep/storage/storage.h"

namespace pointsweep {

/// A file that is written as `.<name>.<pid>.part` beside its destination and renamed by seal(); otherwise the
/// destructor removes it. Every failure is an Error that names the destination and says what to do (no space left,
/// folder missing, read-only).
///
/// An output to a URL is written to a file without a name in a folder for temporary files, and uploaded by seal().
///
/// A destination for which is_standard_output() is true is standard output. Bytes go there immediately and in sequence;
/// bytes written before an error remain.
class OutputFile final : public Unsealed {
 public:
  /// Throws before anything is written if the destination exists and `overwrite` is false, if it is a folder, or if its
  /// folder is missing. `temp_folder`: folder for the bytes of an output to a URL; empty for the system's folder.
  OutputFile(const std::filesystem::path& destination, bool overwrite, const std::filesystem::path& temp_folder = {});
  ~OutputFile() override;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws the errors that the constructor throws because of the state of the destination, but makes no file. Not for
  /// standard output.
  static void require_possible(const std::filesystem::path& destination, bool overwrite);
  /// Returns the path of the file that holds an output of this process until the output is complete.
  static std::filesystem::path unfinished_path(const std::filesystem::path& destination);

  void append(std::span<const std::byte> bytes) override;
  /// Writes bytes from `offset` on. Thread-safe for bytes that do not overlap, if is_seekable().
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes) override;
  /// Fills `bytes` with the bytes written from `offset` on.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  std::uint64_t size() const { return size_; }  ///< returns the number of bytes that append() has written
  void seal() override;
  /// Returns whether bytes may be written at any place and read back; false for standard output.
  bool is_seekable() const { return !is_stream_; }

 private:
  void open_for_upload(const std::filesystem::path& temp_folder);
  void rename_to_destination();
  [[noreturn]] void fail_to_write(int error) const;

  std::filesystem::path destination_, part_;
  bool overwrite_ = false;
  bool is_stream_ = false;
  bool is_remote_ = false;
  bool incomplete_ = false;            ///< true until the output is complete; false for standard output
  std::filesystem::path temp_folder_;  ///< folder for the bytes of an output to a URL
  FileDescriptor file_;
  std::uint64_t size_ = 0;
  std::uint64_t streamed_ = 0;        ///< bytes written to standard output
  std::optional<Leftover> leftover_;  ///< entry for `part_`, the file to remove if the process is stopped
};

}  // namespace pointsweep
