// SPDX-License-Identifier: MIT
/// An independent check of the output of a run. All points are compared to find losses. Made attributes are computed
/// again for a sample, without code of the search and the sweep. docs/reliability.md has the rules. Programs that
/// include this header link pointsweep::verify.
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
  std::uint64_t sample = 10000;          ///< number of points whose made attributes are evaluated again
  std::uint64_t seed = 0;                ///< seed of the random choice of these points
  std::vector<std::uint64_t> rows = {};  ///< rows to check in addition, in any order
  /// Order of the output's rows; if absent, the recorded order, or an order that the check guesses.
  std::optional<Order> order = {};
  std::optional<int> axis = {};        ///< axis of the sweep, 0, 1 or 2; absent for the longest
  std::string prefix = {};             ///< RunOptions::prefix of the run
  std::optional<int> decimals = {};    ///< FileLayout::decimals of the run
  std::optional<Type> positions = {};  ///< RunOptions::positions of the run
  /// Memory for neighbourhoods in bytes. A sample that needs more is checked in several passes.
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
  /// Called between pieces of work with the work done and the total; may throw to end the check.
  std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> progress = {};

  /// The run that made the output, needed if the output has no record. `pipeline`: text, JSON or the name of a JSON
  /// file. `neighborhood`, if the pipeline has no knn: the options of knn, e.g. {{"k", std::uint64_t{12}}}. `keep`:
  /// Chain::keep.
  std::string pipeline = {};
  Options neighborhood = {};
  std::vector<std::string> keep = {};
  OutputDivision division = {};  ///< RunOptions::division of the run, if the files in the folder have no record
  Nonfinite nonfinite = Nonfinite::by_format;  ///< RunOptions::nonfinite of the run
  bool recursive = false;                      ///< true if folders among the inputs include their sub-folders
  CloudOptions cloud = {};                     ///< rules by which the inputs become one cloud
};

/// The comparison of one attribute of the input with its copy in the output, in the type of the output.
struct AttributeArrival {
  std::string name;
  std::uint64_t sum_in = 0, sum_out = 0;  ///< checksums that do not depend on the order of the points
  std::uint64_t rows_different = 0;       ///< number of rows whose values differ
  std::uint64_t first_different = 0;      ///< first row whose values differ
  double expected = 0, found = 0;         ///< values of input and output in row `first_different`
  double rounded_by = 0;  ///< of x, y and z, the largest change of a value by storing it in the type of the output
};

/// The comparison of all points and attributes of the input with the points and attributes of the output.
struct Arrivals {
  std::vector<AttributeArrival> attributes;
  std::vector<std::string> missing;  ///< attributes of the input that the output lacks
  std::uint64_t points_in = 0, points_out = 0;
  std::uint64_t sum_in = 0, sum_out = 0;  ///< checksums of whole points, all attributes together
  std::uint64_t rows_different = 0;       ///< number of rows in which input and output have different points
  /// First row in which input and output have different points, or that only one of them has; absent if all rows are
  /// equal.
  std::optional<std::uint64_t> first_different;
  /// For x, y and z, true if the points of the output ascend, with non-finite points at the end.
  std::array<bool, 3> ascending{true, true, true};
  Box bounds;                   ///< bounds of the finite points of the input
  std::uint64_t nonfinite = 0;  ///< number of points of the input with NaN or infinite coordinates

  /// Returns whether input and output have the same points with the same attributes in each row.
  bool row_by_row() const { return missing.empty() && !first_different; }
  /// Returns whether input and output have the same points with the same attributes, in any order.
  bool in_some_order() const { return missing.empty() && points_in == points_out && sum_in == sum_out; }
};

/// The findings of a check.
struct Verdict {
  std::string input, output;  ///< names of the input and of the output
  /// Number of points with non-finite coordinates that the run has dropped. Row numbers do not count these points.
  std::uint64_t dropped = 0;
  std::uint64_t points_of_inputs = 0;  ///< number of points of the inputs, before stages leave any out
  Arrivals arrivals;
  bool attributes_compared = true;  ///< false for arrays, which hold no attributes of the input
  std::string order;                ///< order of the rows: "input" or "sweep along x"; empty for any other order
  std::vector<std::string> made;    ///< names of the made attributes that were evaluated again by brute force
  /// Names of the made attributes without an independent formula, which the operator itself has computed again.
  std::vector<std::string> by_own_operator;
  std::uint64_t values = 0;        ///< number of values that were evaluated again
  std::uint64_t open_values = 0;   ///< number of these values that are undecided, because of a tie within rounding
  std::uint64_t sampled = 0;       ///< number of points whose values were evaluated
  std::uint64_t wrong_points = 0;  ///< number of points of the sample with a wrong value
  std::uint64_t passes = 0;        ///< number of times that the whole input was read
  /// Number of rows that a select after other stages has dropped; absent without such a select.
  std::optional<std::uint64_t> left_out;
  std::uint64_t open_rows = 0;  ///< number of sampled rows for which the data do not decide whether a select keeps them
  /// Names of attributes of the output that are not checked, since neither the input has them nor a stage makes them.
  std::vector<std::string> unknown;
  std::vector<std::string> untold;  ///< sentences about values that are not checked, with the reasons

  /// Number of rows that differ from the rows of the input; 0 if rows are not compared one by one.
  std::uint64_t different_rows = 0;
  std::uint64_t difference_count = 0;    ///< number of all differences
  std::vector<std::string> differences;  ///< sentences about the first few differences

  bool same() const { return difference_count == 0; }
  /// Returns whether everything was checked and no value or row stayed undecided.
  bool is_complete() const { return open_values == 0 && open_rows == 0 && unknown.empty() && untold.empty(); }
};

/// Checks the file, the folder of files or the array `output` that a run has written from `inputs`, which are files,
/// folders and patterns. Without inputs, the record in the output gives the inputs and the pipeline. The formula of a
/// stage is found by the name of its operator, so that only operators of the library are checked. Throws UsageError if
/// neither the output nor the options give the run, and for requests that cannot be checked; Error for files that
/// cannot be read.
POINTSWEEP_EXPORT Verdict verify(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                                 const VerifyOptions& options = {});

enum class Checksums : bool { leave_out, show };

/// Returns lines for people: the differences, what was compared, what was not checked, and conclusion().
POINTSWEEP_EXPORT std::string to_text(const Verdict& verdict, Checksums checksums = Checksums::leave_out);

/// Returns the last line of to_text(), without a full stop: "OK: inputs unchanged, 10,000 samples correct"; the numbers
/// of values, rows, attributes and stages that are not checked; or the number of rows that differ or of samples that
/// are wrong.
POINTSWEEP_EXPORT std::string conclusion(const Verdict& verdict);

}  // namespace pointsweep
