// SPDX-License-Identifier: MIT
/// The check of one output: the stages of its run that can be checked, the rows of the input on which they are checked,
/// the output of a divided run as one cloud, and the check of an output of a known run.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/run.h"
#include "pointsweep/verify.h"
#include "pointsweep/verify/rows/made_values.h"
#include "pointsweep/verify/rows/row_source.h"
#include "pointsweep/verify/search/surroundings.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// The differences between an output and what its run should have made.
struct Differences {
  std::uint64_t count = 0;
  std::vector<std::string> sentences = {};  ///< messages about the first ten

  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    if (++count <= 10) sentences.push_back(fmt::format(format, std::forward<Args>(args)...));
  }
};

/// The stages of the run that made an output, and the facts about the output that the check needs.
struct MadeBy {
  NeighborRule neighborhood = {};
  SharedRule rule = {};  ///< rule that shortens each neighbourhood; null for none
  std::vector<StageOperator> operators = {};
  std::vector<std::string> keep = {};  ///< names of the made attributes that were written; empty: all
  /// Attributes that are not checked, because they do not follow from a sample of the input, e.g. because points have
  /// moved (see made_by()).
  std::vector<Attribute> unchecked = {};
  /// All points of the cloud before voxel(keep=centroid); the input of the check then has one point of each voxel. Null
  /// without such a stage.
  std::shared_ptr<InputCloud> before_means = {};
  /// The threshold of outliers, found in the output (outlier_threshold()). If the output lacks rows, or a later stage
  /// has made the mean distances again, verify() computes the threshold from the input.
  CloudThreshold outlier_threshold = {};
  /// True if a select follows other stages, so that the output lacks some rows of the input.
  bool leaves_out = false;
  /// True if the order of the rows is unknown: neither the order of the input nor an order that the points determine.
  bool in_any_order = false;
  Differences known = {};  ///< differences that were found before the check of values
  /// True if stages that are not checked also drop rows, so that a row may be missing because of such a stage.
  bool leaves_out_more = false;
  std::vector<std::string> untold = {};  ///< sentences about values that are not checked, with reasons
  /// Names of fields that were not written: fields of kept made attributes, and fields of the input.
  std::set<std::string> left_out_made = {}, left_out_input = {};
  OwnField own_field = nullptr;      ///< Format::own_field of the output's format; null if it has none
  StoredName stored_name = nullptr;  ///< Format::stored_name of the output's format; null if it has none
  /// True if the output has NaN for all coordinates of a point that is not finite.
  bool loses_nonfinite = false;
};

/// Checks whether `out` equals the result of a run over `in`. For all points, it compares the count, and each attribute
/// by value, row by row, or, if the order of the rows differs, by checksums of values and of whole points. For a
/// sample, it compares the made attributes with the formulas of the operators, evaluated on neighbourhoods that a
/// brute-force search finds. `is_array`: `out` holds made values only. Values are compared with the precision of the
/// output's types (FieldPair).
///
/// If a select after other stages drops rows, half of the sample (or fewer, if fewer were dropped) are rows that the
/// output does not have. The earlier stages are evaluated on these rows of the input, and then the conditions, which
/// decide whether a row stays.
///
/// Reads both files once. Reads the input again for each ring of neighbours that the chain reads (normals and splats 1,
/// curvature 2, fairing with splats from curvature 3), for the order of a sweep, for dropped rows, and for stages that
/// depend on all points. If the sample does not fit in memory with its neighbours, it is checked in parts, and the
/// rings are read for each part. A thin subset of the cloud first gives an upper bound for the distances of the
/// neighbours of each chosen point. Each point of the input is then compared only with the chosen points within their
/// bounds. A pass takes about 0.3 µs per point.
Verdict verify(InputCloud& in, RowSource& out, bool is_array, const MadeBy& made_by, const VerifyOptions& options = {});

/// Returns the newest record of a point file; none if the file is an array, has no record or a record without stages.
std::optional<ProvenanceRecord> recorded_run(const std::filesystem::path& file);

/// Returns the paths of the inputs of a recorded run, in their order. Looks for an input under its absolute path or URL
/// if the record states it, then in the folder of `file`, then in the current folder. Throws Error if an input is
/// missing or has another size, UsageError if the record does not name all inputs.
std::vector<std::filesystem::path> recorded_inputs(const ProvenanceRecord& record, const std::filesystem::path& file);

/// Returns the stages of a plan that can be checked: up to the first new neighbourhood or voxel(keep=centroid), without
/// stages that depend on all points after points have moved, without stages that read an attribute of an unchecked
/// stage, and, after a select that follows other stages, without stages that read neighbours or depend on all points.
/// MadeBy::unchecked lists the attributes that the unchecked stages make. Selects at the beginning of the chain are in
/// neither list (see rows_kept_first()).
MadeBy made_by(const ChainPlan& plan);

/// Limits a check to the selects after other stages, so that it compares no made attribute.
void leave_selects(MadeBy& made);

/// Adds to `made` the fields that --keep has excluded from the output.
void leave_out(const KeptFields& named, const std::string& prefix, const Schema& input, MadeBy& made);

/// The rows of the input that stages have kept.
struct KeptRows {
  InputCloud cloud;                          ///< rows that the selects and thinnings at the beginning of the chain keep
  std::shared_ptr<InputCloud> before_means;  ///< rows before voxel(keep=centroid); null without such a stage
};

/// Returns the rows of `cloud` that the selects and thinnings at the beginning of the chain keep. Throws UsageError for
/// a thinning after other stages, and for any stage that drops rows after voxel(keep=centroid).
KeptRows rows_kept_first(const VerifyOptions& options, const InputCloud& cloud, const ChainGraph& graph);

/// Returns the division that the record of an output states; none if the output is not divided.
OutputDivision recorded_division(const ProvenanceRecord& record);

struct DividedOutput {
  InputCloud own;         ///< points of all files, without points of buffers
  Differences misplaced;  ///< points in the wrong file, and files with a wrong name or buffer
};

/// The name of the attribute that is 0 for points of a tile and another number for points of its buffer.
inline constexpr const char* kBuffer = "buffer";

/// Returns the points of a divided output, and the faults of the division. Reads all files once.
DividedOutput read_divided(const std::vector<std::filesystem::path>& files, const OutputDivision& division,
                           const PhaseProgress& progress);

}  // namespace pointsweep
