// SPDX-License-Identifier: MIT
/// A chain of operators, as a user asks for it.
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

/// The stages after it have the neighbourhoods of the current positions, exact and certified like the first ones: they
/// make what they would make of a file that holds these positions in float64 and everything made so far. Points that a
/// mover has taken to a place that is not finite have no neighbours from here on.
///
/// Without it, neighbourhoods stay those of the positions before, wherever the points go. Cost: one more sweep, and
/// between the two one temporary record for each point, of the positions and of what is still needed. With Resort it is
/// what the paper asks for in Section 8: "new sort-update and k-nearest-update stream operators".
struct Reneighbor {
  /// The previous definition of a neighbourhood applies.
  Reneighbor() = default;
  explicit Reneighbor(Neighborhood next) : neighborhood(std::make_shared<const Neighborhood>(std::move(next))) {}
  std::shared_ptr<const Neighborhood> neighborhood;  ///< null: the previous one
};

/// With Order::sweep the output has its rows in canonical order of the current positions, along the axis of their
/// largest extent unless one is chosen, exactly as sort() of a file that holds these positions in float64. Without it
/// that order is the one of the input's positions, also after Reneighbor. An order never changes a value:
/// neighbourhoods stay the same, and with Order::input it is a no-op. The last one in a chain counts. Cost: none in the
/// sweep, one more ordering of the output.
struct Resort {};

/// Later stages do not see these attributes, and they are not written: attributes made before, or fields of the input
/// in any spelling. x, y and z are always written.
struct Drop {
  std::vector<std::string> attributes;
};

class InOrderOperator;
class ConnectOperator;
class CompositeOperator;

/// An entry of a chain. A shared pointer to an operator converts to the kind that it is.
using ChainStage = std::variant<std::shared_ptr<const LocalOperator>,      ///< makes attributes from neighbourhoods
                                std::shared_ptr<const SelectOperator>,     ///< drops rows by a condition on a point
                                std::shared_ptr<const InOrderOperator>,    ///< takes all points in order
                                std::shared_ptr<const ConnectOperator>,    ///< joins neighbours by edges
                                std::shared_ptr<const CompositeOperator>,  ///< is short for other stages
                                Drop, Reneighbor, Resort>;

/// An operator that is short for other stages, which follow each other in its place.
class POINTSWEEP_EXPORT CompositeOperator : public Operator {
 public:
  virtual std::vector<ChainStage> parts() const = 0;
};

/// Neighbourhoods, and what is computed from them, in order. Built-in operators come from operators.h, or by name from
/// the functions below:
///
///   Chain chain{.neighborhood = {.k = 16}, .stages = {operators::normals(), std::make_shared<Roughness>()}};
struct Chain {
  Neighborhood neighborhood = {.k = Neighborhood::kOfOperators};
  std::vector<ChainStage> stages = {};
  /// Attributes to write, by the name of the attribute ("normal") or of its column ("nx"). Of the made attributes those
  /// named are written, or all if none is named; of those of the input likewise; positions always are. Empty: all.
  std::vector<std::string> keep = {};
};

/// The chain that a pipeline describes, as text, `knn(k=16) | normals(orient=up) | where(nz > 0.5)`, or as JSON,
/// `[{"type": "knn", "k": 16}, {"type": "normals", "orient": "up"}]`. docs/pipelines.md has the language and
/// docs/operators.md the operators with their options. Where it names neither k nor a radius, each point has as many
/// neighbours as the largest Contract::default_k of its operators says, or all within their largest
/// Contract::all_within. Throws UsageError, naming the place in the text, for an unknown name and a value out of range.
POINTSWEEP_EXPORT Chain parse_chain(std::string_view pipeline, const Cloud& cloud);

/// Appends the stages of a pipeline, which has no `knn`, to a chain for the same cloud.
POINTSWEEP_EXPORT void append_stages(Chain& chain, std::string_view pipeline, const Cloud& cloud);

/// Appends the built-in operator `name` with these options, e.g. "normals", {{"orient", "up"}}; a text is read as in a
/// pipeline. Options that are not given have the defaults of docs/operators.md. Throws UsageError.
POINTSWEEP_EXPORT void append_stage(Chain& chain, const std::string& name, const Options& options, const Cloud& cloud);

}  // namespace pointsweep
