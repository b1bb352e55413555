// SPDX-License-Identifier: MIT
/// The members of an NPZ file, which is a zip archive.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/storage/local/input_file.h"

namespace pointsweep {

struct NpzMember {
  std::string name;                  ///< without ".npy"
  std::uint64_t begin = 0, end = 0;  ///< range of its bytes in the file
};

/// Returns whether a file that begins with `head` is a zip archive whose first member is a NumPy array.
bool starts_as_npz(std::string_view head);

/// Returns the arrays in an archive of any size (zip64). Throws Error for a damaged archive and for compressed members.
std::vector<NpzMember> npz_members(const InputFile& file);

}  // namespace pointsweep
