// SPDX-License-Identifier: MIT
/// The check of one output of which it is known what the run was asked to make.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/verify.h"
#include "pointsweep/verify/rows/made_fields.h"
#include "pointsweep/verify/rows/row_source.h"
#include "pointsweep/verify/search/surroundings.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// The request of the run: its stages and what it wrote.
struct MadeBy {
  NeighborRule neighborhood = {};
  SharedRule rule = {};  ///< shortens the neighbourhood
  std::vector<StageOperator> operators = {};
  std::vector<std::string> keep = {};  ///< names of the made attributes that were written; empty: all
  /// Made too, but from neighbours of moved points, which no sample of the input tells: they are not checked.
  std::vector<Attribute> unchecked = {};
  /// All points of the cloud before voxel(keep=centroid); the input of the check holds one of each voxel.
  std::shared_ptr<InputCloud> before_means = {};
  /// The threshold of outliers, found in the output (outlier_threshold.h).
  CloudThreshold outlier_threshold = {};
  /// Selects after other stages are among the operators: the output has a part of the rows of the input.
  bool leaves_out = false;
  /// The output has the rows in an order that neither the input nor the points tell.
  bool in_any_order = false;
  std::vector<std::string> known_differences = {};  ///< of the output, found before the check
  std::uint64_t more_differences = 0;               ///< further ones
  /// Other stages leave out rows too, so that a row that the output has not may have gone there.
  bool leaves_out_more = false;
  std::vector<std::string> untold = {};  ///< sentences about what is not checked, and why
  /// Fields that were not written: of kept made attributes, and of the input under the input's own names.
  std::set<std::string> left_out_made = {}, left_out_input = {};
  OwnField own_field = nullptr;  ///< of the output's format
};

/// Checks whether `out` is what a run over `in` gives. Every point: the count, and each attribute by value, row by row
/// or, in the order of the sweep, by checksums of values and of whole points. A sample: the made attributes equal those
/// that the formulas of the operators give for neighbourhoods found by holding every point of the input against them.
/// `is_array`: `out` holds made values only. Values are compared as far as the types of the output tell (FieldPair).
///
/// If rows are left out after other stages, half of the sample are rows that the output does not have: the conditions
/// are evaluated on what the stages before make of all rows of the input, and tell whether a row stays.
///
/// Reads both files once, the input once more for each ring of neighbours a chain looks at (normals and splats 1,
/// curvature 2, fairing with splats again 3), and once for an order of the sweep. A point of the stream is held against
/// those chosen points only whose neighbours can be that far away, as a first look at a 65,536th of the cloud or
/// at most 65,536 points says; that bound is proven, not guessed. About 0.3 µs per point and pass.
Verdict verify(InputCloud& in, Reader& out, bool is_array, const MadeBy& made_by, const VerifyOptions& options = {});

}  // namespace pointsweep
