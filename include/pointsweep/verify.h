// SPDX-License-Identifier: MIT
/// The user's own check of what a run has written: nothing was lost, and what operators made is right. It looks at
/// every point for the first and at a sample for the second, and shares no code with the search and the sweep that it
/// checks. docs/reliability.md has the rules. Programs that include this header link pointsweep::verify.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/option.h"
#include "pointsweep/run.h"

namespace pointsweep {

struct VerifyOptions {
  std::uint64_t sample = 10000;                         ///< points whose made attributes are evaluated again
  std::uint64_t seed = 0;                               ///< which ones
  std::vector<std::uint64_t> rows = {};                 ///< in addition, in any order
  std::optional<Order> order = {};                      ///< of the output's rows; absent: the record's, or found out
  std::optional<int> axis = {};                         ///< of the sweep: 0, 1, 2; absent: the longest
  std::string prefix = {};                              ///< RunOptions::prefix of the run
  std::optional<int> decimals = {};                     ///< FileLayout::decimals of the run
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;  ///< for neighbourhoods; what does not fit is done in turns
  /// Called between pieces of work with what is done and how much there is; may throw to end it.
  std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> progress = {};

  /// The run that made the output, where the output has no record of it: the pipeline as text or JSON or the name of a
  /// JSON file, else the options of its knn, e.g. {{"k", std::uint64_t{12}}}, and Chain::keep.
  std::string pipeline = {};
  Options neighborhood = {};
  std::vector<std::string> keep = {};
  OutputDivision division = {};  ///< RunOptions::division of the run, if the files in the folder have no record
  Nonfinite nonfinite = Nonfinite::by_format;  ///< RunOptions::nonfinite of the run
  bool recursive = false;                      ///< folders among the inputs stand for the files in their folders, too
  CloudOptions cloud = {};                     ///< how the inputs become one cloud
};

/// One attribute of the input, as the output's type holds it.
struct AttributeArrival {
  std::string name;
  std::uint64_t sum_in = 0, sum_out = 0;  ///< checksums that do not depend on the order of the points
  std::uint64_t rows_different = 0;       ///< rows whose values differ, row by row
  std::uint64_t first_different = 0;      ///< the first of them
  double expected = 0, found = 0;         ///< there
};

/// The comparison of all points and attributes of the input with those of the output.
struct Arrivals {
  std::vector<AttributeArrival> attributes;
  std::vector<std::string> missing;  ///< attributes of the input that the output has not
  std::uint64_t points_in = 0, points_out = 0;
  std::uint64_t sum_in = 0, sum_out = 0;            ///< checksums of whole points, all attributes together
  std::uint64_t rows_different = 0;                 ///< rows of both whose points differ
  std::optional<std::uint64_t> first_different;     ///< row whose points differ; a row that only one file has counts
  std::array<bool, 3> ascending{true, true, true};  ///< the output, along x, y, z, with not finite points at its end
  Box bounds;                                       ///< of the finite points of the input
  std::uint64_t nonfinite = 0;                      ///< points of the input with NaN or infinite coordinates

  bool row_by_row() const { return missing.empty() && !first_different; }
  /// Returns whether both have the same points with the same attributes, in any order.
  bool in_some_order() const { return missing.empty() && points_in == points_out && sum_in == sum_out; }
};

/// The findings of a check.
struct Verdict {
  std::string input, output;  ///< names
  /// Points of the input without a finite place that the run has left out. Numbers of rows count the others.
  std::uint64_t dropped = 0;
  Arrivals arrivals;
  bool attributes_compared = true;  ///< false for arrays, which hold none of the input's
  std::string order;                ///< "input" or "sweep along x"; empty if the rows are in neither
  std::vector<std::string> made;    ///< attributes that operators made, by brute force again
  /// The attributes of `made` that have no independent formula. They are recomputed by the operator itself.
  std::vector<std::string> by_own_operator;
  std::uint64_t values = 0;        ///< values that were evaluated again
  std::uint64_t open_values = 0;   ///< of these, some of which the data do not tell what is right (a tie to rounding)
  std::uint64_t sampled = 0;       ///< points for which they were
  std::uint64_t wrong_points = 0;  ///< of these, with a value that is not as it should be
  std::uint64_t passes = 0;        ///< times that the whole input was read
  std::optional<std::uint64_t> left_out;  ///< rows that a stage after others has left out
  std::uint64_t open_rows = 0;            ///< of the sample: the data do not tell whether they stay
  std::vector<std::string> unknown;  ///< attributes of the output that are neither the input's nor made: not checked
  std::vector<std::string> untold;   ///< what is not checked, and why

  std::uint64_t different_rows = 0;  ///< rows that differ from the input's; 0 if rows are not compared one by one
  std::uint64_t difference_count = 0;
  std::vector<std::string> differences;  ///< the first few, a sentence each

  bool same() const { return difference_count == 0; }
  /// Returns whether nothing that was to be checked stayed undecided.
  bool is_complete() const { return open_values == 0 && open_rows == 0 && unknown.empty() && untold.empty(); }
};

/// Checks the file, the folder of files or the array `output` that a run has written from `inputs`: files, folders and
/// patterns. Without inputs, the record in the output names the inputs and the pipeline. The formula of a stage is
/// found by the name of its operator, so the operators are those of the library. Throws UsageError where neither the
/// output nor the options say how it was made, and for what cannot be checked; Error for files that cannot be read.
POINTSWEEP_EXPORT Verdict verify(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                                 const VerifyOptions& options = {});

enum class Checksums : bool { leave_out, show };

/// Several lines for people: what differs, what was compared, what was not checked, and conclusion().
POINTSWEEP_EXPORT std::string to_text(const Verdict& verdict, Checksums checksums = Checksums::leave_out);

/// The last line: "OK: inputs unchanged, 10,000 samples correct"; how many values, rows, attributes and stages are not
/// checked; or in how many rows the output differs. Without a full stop.
POINTSWEEP_EXPORT std::string conclusion(const Verdict& verdict);

}  // namespace pointsweep
