// SPDX-License-Identifier: MIT
/// A chain of operators: the request of a user.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "pointsweep/export.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operator.h"
#include "pointsweep/option.h"

namespace pointsweep {

class Cloud;

/// Searches the neighbourhoods again, at the current positions, for all later stages. The new neighbourhoods are exact
/// and certified like the first neighbourhoods. Later stages give the same results as for a file that holds the current
/// positions in float64 and all attributes made so far. Points that were moved to non-finite coordinates have no
/// neighbours in later stages.
///
/// Without Reneighbor, points keep their neighbours when they move. Cost: one more sweep, and before it one temporary
/// record for each point with its position and the attributes still needed. Reneighbor and Resort are the extension
/// that Section 8 of the paper asks for: "new sort-update and k-nearest-update stream operators".
struct Reneighbor {
  /// Keeps the previous definition of a neighbourhood.
  Reneighbor() = default;
  explicit Reneighbor(Neighborhood next) : neighborhood(std::make_shared<const Neighborhood>(std::move(next))) {}
  std::shared_ptr<const Neighborhood> neighborhood;  ///< new definition; null to keep the previous one
};

/// Orders the rows of the output by the current positions. With Order::sweep, the rows are in canonical order along the
/// axis of the largest extent of these positions, or along a chosen axis, exactly as after sort() (run.h) of a file
/// with the positions in float64. Without Resort, rows are ordered by the positions in the input, also after
/// Reneighbor. Resort changes no value and no neighbourhood; with Order::input it is a no-op. The last Resort of a
/// chain counts. Cost: none in the sweep, one more ordering of the output.
struct Resort {};

/// Hides attributes from later stages and from the output: attributes that earlier stages make, or fields of the input
/// in any spelling. x, y and z are always written.
struct Drop {
  std::vector<std::string> attributes;
};

class InOrderOperator;
class ConnectOperator;
class CompositeOperator;

/// An entry of a chain. A shared pointer to an operator converts to the alternative of its kind.
using ChainStage = std::variant<std::shared_ptr<const LocalOperator>,      ///< makes attributes from neighbourhoods
                                std::shared_ptr<const SelectOperator>,     ///< drops rows by a condition on a point
                                std::shared_ptr<const InOrderOperator>,    ///< takes all points in order
                                std::shared_ptr<const ConnectOperator>,    ///< joins neighbours by edges
                                std::shared_ptr<const CompositeOperator>,  ///< stands for other stages
                                Drop, Reneighbor, Resort>;

/// An operator that stands for a sequence of other stages, which replace it.
class POINTSWEEP_EXPORT CompositeOperator : public Operator {
 public:
  virtual std::vector<ChainStage> parts() const = 0;
};

/// A definition of neighbourhoods, and the stages in order. Functions of operators.h make the built-in operators, and
/// the functions below make them by name. Example:
///
///   Chain chain{.neighborhood = {.k = 16}, .stages = {operators::normals(), std::make_shared<Roughness>()}};
struct Chain {
  Neighborhood neighborhood = {.k = Neighborhood::kOfOperators};
  std::vector<ChainStage> stages = {};
  /// Attributes to write, by the name of the attribute ("normal") or of a column ("nx"). If any made attribute is
  /// named, only the named made attributes are written, else all; the same holds for attributes of the input. Positions
  /// are always written. Empty to write all attributes.
  std::vector<std::string> keep = {};
};

/// Returns the chain without Neighborhood::kOfOperators. Each such default is replaced according to the operators up to
/// the next Reneighbor with its own definition: by all points within their largest Contract::all_within, or by their
/// largest Contract::default_k. Throws UsageError if one operator needs all points within a distance and another does
/// not.
POINTSWEEP_EXPORT Chain with_named_neighborhoods(Chain chain);

/// Parses a pipeline: text, `knn(k=16) | normals(orient=up) | where(nz > 0.5)`, or as JSON, `[{"type": "knn", "k": 16},
/// {"type": "normals", "orient": "up"}]`. docs/pipelines.md has the language and docs/operators.md the operators with
/// their options. If the pipeline states neither k nor a radius, the number of neighbours is the largest
/// Contract::default_k of its operators, or the radius is their largest Contract::all_within. Throws UsageError, naming
/// the place in the text, for an unknown name and a value out of range.
POINTSWEEP_EXPORT Chain parse_chain(std::string_view pipeline, const Cloud& cloud);

/// Appends the stages of `pipeline`, which must not contain `knn`, to `chain`. `cloud`: the cloud over which the chain
/// will run. Throws the errors of parse_chain().
POINTSWEEP_EXPORT void append_stages(Chain& chain, std::string_view pipeline, const Cloud& cloud);

/// Appends the built-in operator `name` with these options, e.g. "normals", {{"orient", "up"}}; a value that is a text
/// is read as in a pipeline. Absent options have the defaults of docs/operators.md. Throws UsageError for an unknown
/// name and for a value out of range.
POINTSWEEP_EXPORT void append_stage(Chain& chain, const std::string& name, const Options& options, const Cloud& cloud);

}  // namespace pointsweep
