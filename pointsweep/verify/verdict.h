// SPDX-License-Identifier: MIT
/// What a check found.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/verify/arrivals.h"

namespace pointsweep {

struct Verdict {
  std::string input, output;  ///< names
  Arrivals arrivals;
  bool attributes_compared = true;  ///< false for arrays, which hold none of the input's
  std::string order;                ///< "input" or "sweep along x"; empty if the rows are in neither
  std::vector<std::string> made;    ///< attributes that operators made, by brute force again
  /// Those of them for which `verify` has no independent formula: evaluated with the operator that made them.
  std::vector<std::string> by_own_operator;
  std::uint64_t values = 0;        ///< values that were evaluated again
  std::uint64_t open_values = 0;   ///< of these, some of which the data do not tell what is right (a tie to rounding)
  std::uint64_t sampled = 0;       ///< points for which they were
  std::uint64_t wrong_points = 0;  ///< of these, with a value that is not as it should be
  std::uint64_t passes = 0;        ///< times that the whole input was read
  std::optional<std::uint64_t> left_out;  ///< rows that a stage behind others has left out
  std::uint64_t open_rows = 0;            ///< of the sample: the data do not tell whether they stay
  std::vector<std::string> unknown;  ///< attributes of the output that are neither the input's nor made: not checked
  std::vector<std::string> untold;   ///< what is not checked, and why

  std::uint64_t different_rows = 0;  ///< rows that differ from the input's; 0 if rows are not compared one by one
  std::uint64_t difference_count = 0;
  std::vector<std::string> differences;  ///< the first few, a sentence each

  bool same() const { return difference_count == 0; }
  /// Nothing that was to be checked stayed undecided.
  bool is_complete() const { return open_values == 0 && open_rows == 0 && unknown.empty() && untold.empty(); }
};

enum class Checksums : bool { leave_out, show };

/// Several lines for people: what differs, what was compared, what was not checked, and conclusion().
std::string to_text(const Verdict& verdict, Checksums checksums = Checksums::leave_out);

/// The last line: "OK: inputs unchanged, 10,000 samples correct"; how many values, rows, attributes and stages are not
/// checked; or in how many rows the output differs. Without a full stop.
std::string conclusion(const Verdict& verdict);

}  // namespace pointsweep
