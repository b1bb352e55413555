// SPDX-License-Identifier: MIT
/// The record of the runs that made a file: lines that point files carry in comments (docs/formats.md).
///
///   pointsweep 0.1.0
///   pointsweep stage knn(k=12)
///   pointsweep stage normals
///   pointsweep order sweep
///   pointsweep input 4000 points, 48211 bytes: scan.ply
///
/// The line with the version begins a record; the newest record is the last. A record states no date, no machine and,
/// unless the user asks for it, no folder, so that equal runs give equal bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pointsweep {

/// The beginning of every line of provenance.
inline constexpr std::string_view kProvenanceMark = "pointsweep ";

struct ProvenanceInput {
  std::string name;  ///< file name without folder, or the absolute path if the user asked for it
  std::uint64_t points = 0, bytes = 0;
};

/// The record of one run.
struct ProvenanceRecord {
  std::string version;
  std::vector<std::string> stages;                            ///< stages in the language of pipelines, or "sort" or
                                                              ///< "convert"
  std::vector<std::pair<std::string, std::string>> settings;  ///< "order", "keep", ... and their values
  std::vector<ProvenanceInput> inputs;
  std::uint64_t more_inputs = 0;  ///< number of inputs whose names are left out, since there are too many

  /// Returns the value of a setting, or nothing.
  std::optional<std::string> setting(std::string_view name) const;
};

/// Returns lines of printable ASCII, each under 1,000 bytes: a longer stage or setting continues in lines that begin
/// with "pointsweep + ". Other bytes, '%', and spaces at either end or after a space are written as %XX. An input whose
/// line would be longer loses its folders.
std::vector<std::string> lines_of(const ProvenanceRecord& record);
/// Parses lines, each of which begins with kProvenanceMark, into records, oldest first. A line "NAME VALUE" of an
/// unknown kind becomes a setting.
std::vector<ProvenanceRecord> records_of(std::span<const std::string> lines);
/// Returns a line such as "pointsweep 0.1.0: knn(k=12) | normals; order sweep; from scan.ply", in printable ASCII.
std::string to_text(const ProvenanceRecord& record);

/// Appends the records of `more` that `lines` does not have yet. The first record that would exceed a total of 256 KiB
/// and all later records are left out, so that headers stay readable; one more line then says so.
void add_provenance(std::vector<std::string>& lines, std::span<const std::string> more);
/// Returns the rest of `all` after `present`, if `all` begins with `present`; returns `all` otherwise.
std::span<const std::string> provenance_beyond(std::span<const std::string> all, std::span<const std::string> present);

/// Returns the line without surrounding white space if it then begins with kProvenanceMark, is printable and has at
/// most 60,000 bytes; otherwise nothing.
std::optional<std::string> provenance_line(std::string_view text);
/// Returns the lines of provenance among the lines of a text.
std::vector<std::string> provenance_in(std::string_view text);

}  // namespace pointsweep
