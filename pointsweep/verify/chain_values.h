// SPDX-License-Identifier: MIT
/// The values that a chain of operators gives to chosen points, computed stage by stage from the surroundings of these
/// points in memory, and the values of the whole cloud that the chain needs. Stages of the library are evaluated by
/// independent formulas; operators of users are applied themselves.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/verify/rows/row_source.h"
#include "pointsweep/verify/search/surroundings.h"
#include "pointsweep/verify/values/cloud_formula.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// A function that returns the fields of the output that hold a made attribute; nothing if the attribute was not
/// written.
using OutputColumns = std::function<std::optional<std::vector<FieldPair>>(const Attribute& made)>;

/// The values of the kept attributes (ChainValues::made()) of some points, ordered by point, then by attribute.
struct ChainResults {
  std::vector<std::byte> values;  ///< result_bytes() for each point, in the types of the attributes
  Estimates estimates;            ///< estimates_per_point() for each point: values with error bounds
};

class ChainValues {
 public:
  /// `keep`: names of the made attributes to evaluate; empty for all. `rule`: shortens the lists of neighbours. Throws
  /// UsageError if an operator reads an attribute that neither the input nor an earlier stage has, or if the rule reads
  /// an attribute that the input does not have. A select makes the attribute selection_name(), which is always
  /// evaluated.
  ChainValues(std::vector<StageOperator> operators, const std::vector<std::string>& keep, const Schema& input,
              SharedRule rule = {}, const CloudThreshold& threshold = {});
  /// Returns the name of the selection by the `number`-th operator.
  static std::string selection_name(std::size_t number);
  static bool is_selection(const Attribute& made);

  /// Returns the kept attributes, each as the last stage that makes it has declared it, in the order in which
  /// attributes were first made.
  const std::vector<Attribute>& made() const { return made_; }
  /// Prepares the stages that depend on all points. Must be called before evaluate(). Returns a sentence for each stage
  /// that cannot be checked fully, with the names of its attributes and the reason.
  std::vector<std::string> look_at_cloud(CloudRows& rows, const NeighborRule& neighborhood, InputCloud* before_means,
                                         const OutputColumns& in_output);
  /// Returns whether made()[a] can be evaluated.
  bool is_told(std::size_t a) const;
  /// Returns whether made()[a] comes from a formula, and not from the operator that also made the output.
  bool is_independent(std::size_t a) const;
  /// Returns the bytes of the result of a point: the values of made(), one after another.
  std::size_t result_bytes() const;
  std::size_t estimates_per_point() const;
  /// Returns the number of rings of points (Surroundings) that need lists of neighbours: 0 without operators; 1 if
  /// stages read only positions and input attributes of neighbours; one more for each link of the longest chain of
  /// stages in which each stage reads what the stage before it has made for neighbours.
  std::size_t rings() const;

  /// Returns the results of the chosen points of `around`, which has rings() rings. Reads records of the input if an
  /// operator or the rule reads attributes of the file; formulas over the whole cloud may read all rows. `rows`: the
  /// rows given to look_at_cloud().
  ChainResults evaluate(Surroundings around, RowSource& in, CloudRows& rows) const;
  /// Evaluates the chain for points whose coordinates are not all finite, which have no neighbours. A stage that reads
  /// only the point itself treats such points as any other, and a cloud formula may state their values
  /// (CloudFormula::unplaced). All other stages leave them unchanged.
  ChainResults evaluate_unplaced(std::span<const KnownPoint> points, RowSource& in) const;
  /// Returns the bytes that the values and estimates of a point of the surroundings take, without its place, its row
  /// and its list of neighbours.
  std::size_t bytes_per_point() const;
  /// Returns an attribute of all rows, computed by the operators themselves and so equal bit by bit to the attribute
  /// that a run makes. Works only for attributes of local stages that follow local stages. The values are ordered by
  /// row of the input, then by component; a point without a finite place has NaN. All values are in memory. Throws
  /// NotTold if the values cannot be computed.
  std::vector<double> made_by_operators(const std::string& attribute, CloudRows& rows,
                                        const NeighborRule& neighborhood);

 private:
  struct Stage {
    StageOperator op;
    /// Formula of the stage; empty if the stage has a cloud formula. A stage without either formula is evaluated by the
    /// operator itself (`applied`).
    StageFormula formula = {};
    std::shared_ptr<CloudFormula> cloud = {};               ///< formula over the whole cloud; null for a local stage
    std::vector<std::optional<ColumnSource>> sources = {};  ///< sources of the values that the cloud formula reads
    std::vector<std::optional<ColumnSource>> targets = {};  ///< sources of the values that the cloud formula makes
    bool told = true;                                       ///< true if the made values can be evaluated
    /// True if the operator itself is applied, for its own values or for a later applied operator.
    bool applied = false;
    std::vector<std::uint16_t> reads = {}, reads_neighbors = {}, makes = {};
    int position = -1;   ///< column of the moved positions that the stage reads; negative for positions of the input
    bool alone = false;  ///< true if the stage reads no lists of neighbours
    int ring = -1;       ///< outermost ring that needs the values of the stage; negative if none needs them
  };
  struct FileColumn {
    std::uint16_t column;
    Attribute attribute;
    std::vector<Field> fields;  ///< fields of the input, one for each component
  };
  using ColumnBytes = std::vector<std::vector<std::byte>>;  ///< values by number of column
  using ColumnEstimates = std::vector<Estimates>;
  /// The values of some points, each in one form or in both.
  struct Values {
    ColumnBytes bits;           ///< exact values in the types of the attributes
    ColumnEstimates estimates;  ///< values with error bounds
  };

  /// Returns the stage that makes a column; null for a column of the input.
  Stage* maker_of(std::uint16_t column) {
    return maker_[column] < 0 ? nullptr : &stages_[static_cast<std::size_t>(maker_[column])];
  }
  const Stage* maker_of(std::uint16_t column) const {
    return maker_[column] < 0 ? nullptr : &stages_[static_cast<std::size_t>(maker_[column])];
  }
  std::uint16_t column_of(const Attribute& wanted, const std::string& stage, const Schema& input);
  void add_file_column(std::uint16_t column, const Attribute& wanted, const std::string& who, const Schema& input);
  void find_applied();
  std::vector<const Operator*> makers_of_reads(const Contract& contract) const;
  std::optional<ColumnSource> source_again(std::uint16_t column, CloudRows& rows) const;
  std::optional<ColumnSource> source_of(std::uint16_t column, const OutputColumns& in_output) const;
  CloudInput cloud_input(const Stage& stage, CloudRows& rows) const;
  void evaluate_cloud(const Stage& stage, const Surroundings& around, CloudRows& rows, ColumnEstimates& columns) const;
  bool take_unplaced(const Stage& stage, const Surroundings& points, Values& values) const;
  void leave_unchanged(const Stage& stage, const Surroundings& points, Values& values) const;
  void take_estimates(std::uint16_t column, Values& values) const;
  std::vector<bool> truncate_lists(Surroundings& around, const ColumnBytes& columns) const;
  formulas::Kept kept_of(const Surroundings& around, std::size_t i, const ColumnBytes& columns,
                         const std::vector<PointColumns>& slots) const;
  std::uint16_t new_column(const Attribute& attribute);
  void make(const Attribute& attribute, Stage& stage);
  void find_rings();
  void need(std::uint16_t column, int ring);
  Values values_of_input(const Surroundings& around, RowSource& in) const;
  void apply(const Stage& stage, const Surroundings& around, ColumnBytes& columns) const;
  void estimate(const Stage& stage, const Surroundings& around, const std::vector<bool>& in_doubt,
                ColumnEstimates& columns) const;
  void evaluate_local(const Stage& stage, const Surroundings& around, const std::vector<bool>& in_doubt,
                      Values& values) const;
  FormulaInput input_of(const Stage& stage, const Surroundings& around, std::size_t i,
                        const ColumnEstimates& columns) const;
  void take_bits(std::uint16_t column, const std::vector<bool>& in_doubt, Values& values) const;
  ChainResults results_of(std::size_t points, const Values& values) const;

  SharedRule rule_;
  NeighborRule neighborhood_;
  InputCloud* before_means_ = nullptr;
  RuleFormula rule_formula_;
  std::vector<std::uint16_t> rule_reads_;
  std::vector<Stage> stages_;
  std::vector<FileColumn> file_columns_;
  std::vector<Attribute> columns_;
  std::vector<int> maker_;  ///< number of the stage that makes each column; -1 for a column of the input
  std::vector<Attribute> made_;
  std::vector<std::uint16_t> made_columns_;
  std::map<std::string, std::uint16_t> latest_;  ///< by name of an attribute, the column of its last values
};

/// Returns the operators, completed by the values of the whole input that they need (Reduction::of_input). Reads the
/// cloud once for each distinct value. Operators without such values are returned unchanged.
std::vector<StageOperator> with_input_values(std::vector<StageOperator> operators, InputCloud& cloud);

/// Returns whether an operator after the first Outlier makes the mean distances again. The output then lacks the
/// distances that Outlier compared.
bool makes_distances_again(const std::vector<StageOperator>& operators);

/// Returns the threshold for the first Outlier among the operators: mean + multiplier * deviation, by the operator's
/// definition, of the finite mean distances of all points of `out`, in extended precision; NaN if no operator is an
/// Outlier, or if the output lacks its mean distances. `prefix`: prefix of the names of made attributes. Reads `out`
/// twice.
CloudThreshold outlier_threshold(RowSource& out, const std::vector<StageOperator>& operators, const std::string& prefix,
                                 const PhaseProgress& progress);

/// Returns the threshold from the mean distances of all points of the input, for an output that lacks some distances.
/// The operators themselves compute the distances. Throws NotTold if the check cannot be made.
CloudThreshold outlier_threshold_of_all(InputCloud& in, const std::vector<StageOperator>& operators,
                                        const SharedRule& rule, const NeighborRule& neighborhood,
                                        std::uint64_t memory_bytes);

}  // namespace pointsweep
