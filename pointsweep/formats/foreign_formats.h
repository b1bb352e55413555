// SPDX-License-Identifier: MIT
/// Files that are recognised only to say what they are.
#pragma once

#include <filesystem>
#include <string_view>

namespace pointsweep {

/// Throws Error for a file that starts with `head` and is of a known format that is not read: what it is, and what to
/// do. Refuses other binary files, too, since they have none of the signatures of `known`, as in "A, B nor C", and are
/// none of `asked_for` ("a or b", Format::asked_for_as), unless the user says so. Returns for anything else.
void refuse_foreign_format(const std::filesystem::path& path, std::string_view head, std::string_view known,
                           std::string_view asked_for);

}  // namespace pointsweep
