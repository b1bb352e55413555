// SPDX-License-Identifier: MIT
/// Statistics of attributes over the neighbours of a point: means, medians, least and greatest values, ranges, standard
/// deviations, majorities, counts (docs/adr/0019).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/expression.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/statistics/statistics_of_values.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

enum class Statistic : std::uint8_t { mean, median, min, max, range, deviation, majority, count };

/// `statistics`: makes one attribute for each name of StatisticsOptions::of. Neighbours count if they satisfy the
/// condition and, except for `count` without an attribute, have a finite value. Sums run in float64 in the order of the
/// search; whole numbers are summed exactly for a mean. min, max and majority keep the type of the attribute. A point
/// without a neighbour that counts has a count of 0. Any other statistic of the point is NaN, or 0 for whole-number
/// types, and makes the point degenerate.
class NeighborhoodStatistics final : public LocalOperator {
 public:
  /// Throws UsageError that begins with `place` for a name that ends in no statistic, or is given twice, and for an
  /// invalid condition.
  explicit NeighborhoodStatistics(const StatisticsOptions& options, std::string place = "statistics");
  std::string name() const override { return "statistics"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  /// Throws UsageError for an unknown attribute, also of the condition; the message names the known attributes.
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  /// An attribute of the neighbours. If `attribute` is empty, the neighbours themselves are counted.
  struct Source {
    std::string attribute;
    NamedValues names = {};      ///< empty before bound()
    Type type = Type::f64;       ///< type of min, max and majority
    std::size_t first_read = 0;  ///< index of its value in contract().reads_neighbors
  };
  /// A column that the operator makes.
  struct Result {
    std::string name;
    Statistic what;
    std::size_t source;
  };
  struct Lists;

  void add_result(const std::string& name);
  Attribute attribute_of(const Result& result) const;
  /// Removes from `lists` the neighbours for which the condition does not hold.
  void keep_those_that_satisfy(const Neighborhoods& in, Lists& lists) const;
  void fill(std::size_t source, const Neighborhoods& in, const Lists& lists, Columns& out) const;
  void fill_counts(std::size_t source, const Lists& lists, Columns& out) const;
  /// `values`: the values of the listed neighbours, list after list.
  template <class Value>
  void fill_from(std::size_t source, std::span<const Value> values, const Lists& lists, Columns& out) const;

  std::string place_;
  std::vector<Source> sources_;
  std::vector<Result> results_;
  std::optional<Expression> condition_;
  NamedValues condition_names_;  ///< empty before bound(); its attributes come first in contract().reads_neighbors
};

struct StatisticText {
  const char* name;
  const char* meaning;  ///< meaning, without the name of the attribute that follows
};

/// Names and meanings of the statistics, in the order of Statistic.
constexpr std::array<StatisticText, 8> kStatistics = {{{"mean", "mean of the neighbours'"},
                                                       {"median", "median of the neighbours'"},
                                                       {"min", "least of the neighbours'"},
                                                       {"max", "greatest of the neighbours'"},
                                                       {"range", "greatest - least of the neighbours'"},
                                                       {"deviation", "standard deviation of the neighbours'"},
                                                       {"majority", "most frequent of the neighbours'"},
                                                       {"count", "number of neighbours with a finite"}}};

/// Largest number of neighbours that are processed together, except for a single point with more.
constexpr std::size_t kNeighborsAtOnce = 4096;

const OptionTable<StatisticsOptions>& statistics_options() {
  static const OptionTable<StatisticsOptions> table = {
      option("of", &StatisticsOptions::of,
             "results, each ATTRIBUTE_STATISTIC with one of the statistics mean, median, min, max, range, deviation, "
             "majority and count, as in intensity_median, z_range, classification_majority; or count, the number of "
             "neighbours; 'of=' may be left out",
             {.kind = OptionKind::attributes, .required = true, .positional = true, .sample = "z_median,z_range"}),
      option("where", &StatisticsOptions::where,
             "only neighbours for which this condition holds count; conditions are those of the operator where",
             {.kind = OptionKind::condition, .sample = "z > 0"})};
  return table;
}

/// Returns whether a statistic is a value of the attribute and so has its type.
bool is_value(Statistic what) {
  return what == Statistic::min || what == Statistic::max || what == Statistic::majority;
}

}  // namespace

OperatorDeclaration statistics_declaration() {
  return {
      .name = "statistics",
      .meaning =
          "statistics of the neighbours' attributes: mean, median, min, max, range, deviation, majority and count",
      .options = statistics_options().declarations(),
      .make = statistics_options().maker<NeighborhoodStatistics>(),
      .formula =
          "v_1, ..., v_n: the finite values of the attribute at the neighbours for which the condition holds, in the "
          "order of the search: nearest first where no stage has moved points since. N_i never holds p_i.\n"
          "mean:      v_1 + m, m = 1/n Σ (v_j - v_1)\n"
          "deviation: √(1/n Σ (v_j - v_1 - m)²), that of the whole population\n"
          "median:    the middle value; of an even number (a + b) / 2 of the two middle ones\n"
          "range:     max - min\n"
          "majority:  the most frequent value; of several the one that comes first\n"
          "count:     n; without an attribute, the neighbours for which the condition holds\n"
          "Sums and differences are float64, and so are mean, deviation, median and range. min, max and majority have "
          "the type of the attribute, whole numbers of 64 bits are exact. count is uint32.",
      .undefined = "Without a neighbour that counts: NaN, of whole numbers 0; count is 0.",
      .degenerate = "have no neighbour that counts; their statistics are NaN, those of whole numbers 0",
      .cost =
          "about 5 ns for each neighbour and statistic; median and majority, which sort, 10 to 70 ns; a condition 15 "
          "ns",
      .neighbor_ns = 20,
      .makes_named = true,
      .example = "knn(k=16) | normals | statistics(z_range, nz_median, count, where=nz > 0)"};
}

ChainStage operators::statistics(const StatisticsOptions& options) {
  return std::make_shared<NeighborhoodStatistics>(options);
}

/// Lists of neighbours, one for each of some successive points of a batch: all, or those for which the condition holds.
/// If some of their values are not finite, fill() makes Lists with `begin` alone for the lists of finite values.
struct NeighborhoodStatistics::Lists {
  std::size_t first_point = 0;
  std::span<const NeighborRef> neighbors = {};
  std::vector<std::size_t> begin = {0};  ///< begin of the list of each point in `neighbors`, then neighbors.size()
  std::vector<NeighborRef> kept = {};    ///< memory of `neighbors` if there is a condition; else empty

  std::size_t points() const { return begin.size() - 1; }
  std::size_t count(std::size_t point) const { return begin[point + 1] - begin[point]; }
};

NeighborhoodStatistics::NeighborhoodStatistics(const StatisticsOptions& options, std::string place)
    : place_(std::move(place)) {
  for (const std::string& name : options.of) add_result(name);
  if (!options.where.empty()) condition_.emplace(options.where, place_ + ": where");
  statistics_options().declare(*this, {options.of, condition_ ? condition_->canonical() : ""});
}

void NeighborhoodStatistics::add_result(const std::string& name) {
  const std::size_t end = name.rfind('_');
  const std::string attribute = end == name.npos ? "" : name.substr(0, end), word = name.substr(end + 1);
  const auto known = std::ranges::find(kStatistics, word, [](const StatisticText& text) { return text.name; });
  const auto what = static_cast<Statistic>(known - kStatistics.begin());
  if (known == kStatistics.end() || (attribute.empty() && name != "count"))
    fail_usage(
        "{}: '{}' names no statistic; write count, or an attribute and mean, median, min, max, range, deviation, "
        "majority or count, as in intensity_median.",
        place_, name);
  if (std::ranges::find(results_, name, &Result::name) != results_.end())
    fail_usage("{}: '{}' is named twice.", place_, name);
  auto source = std::ranges::find(sources_, attribute, &Source::attribute);
  if (source == sources_.end()) source = sources_.insert(source, {.attribute = attribute});
  results_.push_back({name, what, static_cast<std::size_t>(source - sources_.begin())});
}

Attribute NeighborhoodStatistics::attribute_of(const Result& result) const {
  const Source& source = sources_[result.source];
  const Type type = result.what == Statistic::count ? Type::u32 : is_value(result.what) ? source.type : Type::f64;
  Attribute a =
      scalar(result.name, type, "1",
             source.attribute.empty()
                 ? "number of neighbours that count"
                 : fmt::format("{} {}", kStatistics[static_cast<std::size_t>(result.what)].meaning, source.attribute));
  if (!range_of(type).is_whole) a.fill = std::byte{0xff};  // NaN
  return a;
}

Contract NeighborhoodStatistics::contract() const {
  Contract contract{.reads_neighbors = condition_names_.reads(), .default_k = 16};
  for (const Source& source : sources_)
    for (const Attribute& a : source.names.reads()) contract.reads_neighbors.push_back(a);
  for (const Result& result : results_) contract.makes.push_back(attribute_of(result));
  return contract;
}

std::shared_ptr<const LocalOperator> NeighborhoodStatistics::bound(const Schema& input,
                                                                   std::span<const Attribute> made) const {
  auto bound = std::make_shared<NeighborhoodStatistics>(*this);
  if (condition_) bound->condition_names_ = NamedValues(*condition_, place_ + ": where", input, made);
  std::size_t reads = bound->condition_names_.reads().size();
  for (Source& source : bound->sources_) {
    if (source.attribute.empty()) continue;
    const Expression value = expression_of_attribute(source.attribute, place_, input, made);
    if (!value.is_name()) fail_usage("{}: '{}' is not the name of an attribute.", place_, source.attribute);
    source.names = NamedValues(value, place_, input, made);
    source.first_read = reads;
    reads += source.names.reads().size();
    if (source.names.reads().empty()) continue;  // a coordinate
    const MeantValue meant = meant_value(source.attribute, input, made);
    source.type = meant.made != nullptr ? meant.made->type : type_of_values(*meant.field);
  }
  return bound;
}

void NeighborhoodStatistics::apply(const Neighborhoods& in, Columns& out) const {
  for (std::size_t first = 0, end = 0; first < in.size(); first = end) {
    Lists lists{.first_point = first};
    do {
      lists.begin.push_back(lists.begin.back() + in.count(end++));
    } while (end < in.size() && lists.begin.back() + in.count(end) <= kNeighborsAtOnce);
    lists.neighbors = {in.neighbors(first), lists.begin.back()};
    if (condition_) keep_those_that_satisfy(in, lists);
    for (std::size_t source = 0; source < sources_.size(); ++source) fill(source, in, lists, out);
  }
}

void NeighborhoodStatistics::keep_those_that_satisfy(const Neighborhoods& in, Lists& lists) const {
  std::vector<std::uint8_t> holds(lists.neighbors.size());
  for (std::size_t from = 0; from < holds.size(); from += kNeighborsAtOnce) {
    const std::size_t count = std::min(kNeighborsAtOnce, holds.size() - from);
    const NamedValues::Batch batch(condition_names_, in, 0, lists.neighbors.subspan(from, count));
    condition_->evaluate(batch.values(), std::span(holds).subspan(from, count));
  }
  std::size_t from = 0;
  for (std::size_t p = 0; p < lists.points(); ++p) {
    const std::size_t end = lists.begin[p + 1];
    for (; from < end; ++from)
      if (holds[from]) lists.kept.push_back(lists.neighbors[from]);
    lists.begin[p + 1] = lists.kept.size();
  }
  lists.neighbors = lists.kept;
}

void NeighborhoodStatistics::fill(std::size_t source, const Neighborhoods& in, const Lists& lists, Columns& out) const {
  if (sources_[source].attribute.empty()) return fill_counts(source, lists, out);
  const NamedValues::Batch batch(sources_[source].names, in, sources_[source].first_read, lists.neighbors);
  const ExpressionValues& values = batch.values()[0];
  const std::size_t count = lists.neighbors.size();
  if (values.whole != nullptr && values.is_signed) {
    const auto* const numbers = reinterpret_cast<const std::int64_t*>(values.whole);
    return fill_from(source, std::span(numbers, count), lists, out);
  }
  if (values.whole != nullptr) return fill_from(source, std::span(values.whole, count), lists, out);
  const std::span<const double> numbers(values.real, count);
  const auto is_finite = [](double v) { return std::isfinite(v); };
  if (std::ranges::all_of(numbers, is_finite)) return fill_from(source, numbers, lists, out);
  std::vector<double> finite;
  Lists of_finite{.first_point = lists.first_point};
  for (std::size_t p = 0; p < lists.points(); ++p) {
    std::ranges::copy_if(numbers.subspan(lists.begin[p], lists.count(p)), std::back_inserter(finite), is_finite);
    of_finite.begin.push_back(finite.size());
  }
  fill_from(source, std::span<const double>(finite), of_finite, out);
}

void NeighborhoodStatistics::fill_counts(std::size_t source, const Lists& lists, Columns& out) const {
  for (std::size_t r = 0; r < results_.size(); ++r) {
    if (results_[r].source != source || results_[r].what != Statistic::count || !out.wanted(r)) continue;
    const std::span<std::uint32_t> counts = out.column<std::uint32_t>(r).subspan(lists.first_point);
    for (std::size_t p = 0; p < lists.points(); ++p) counts[p] = static_cast<std::uint32_t>(lists.count(p));
  }
}

template <class Value>
void NeighborhoodStatistics::fill_from(std::size_t source, std::span<const Value> values, const Lists& lists,
                                       Columns& out) const {
  fill_counts(source, lists, out);
  std::vector<Value> sorted;
  for (std::size_t r = 0; r < results_.size(); ++r) {
    if (results_[r].source != source || !out.wanted(r)) continue;
    const auto fill_column = [&]<class Made>(const auto& statistic) {
      const std::span<Made> column = out.column<Made>(r).subspan(lists.first_point);
      for (std::size_t p = 0; p < lists.points(); ++p) {
        const std::span<const Value> list = values.subspan(lists.begin[p], lists.count(p));
        column[p] = list.empty() ? std::numeric_limits<Made>::quiet_NaN() : static_cast<Made>(statistic(list));
        if (list.empty()) out.mark_degenerate(lists.first_point + p);
      }
    };
    const auto fill_numbers = [&](const auto& statistic) { fill_column.template operator()<double>(statistic); };
    const auto fill_values = [&](const auto& statistic) {
      with_type(sources_[source].type, [&]<class Made>() { fill_column.template operator()<Made>(statistic); });
    };
    using List = std::span<const Value>;
    switch (results_[r].what) {
      case Statistic::mean:
        fill_numbers([](List list) { return mean_of(list); });
        break;
      case Statistic::median:
        fill_numbers([&](List list) { return median_of(list, sorted); });
        break;
      case Statistic::min:
        fill_values([](List list) { return *std::ranges::min_element(list); });
        break;
      case Statistic::max:
        fill_values([](List list) { return *std::ranges::max_element(list); });
        break;
      case Statistic::range:
        fill_numbers([](List list) { return range_of_values(list); });
        break;
      case Statistic::deviation:
        fill_numbers([](List list) { return deviation_of(list); });
        break;
      case Statistic::majority:
        fill_values([&](List list) { return majority_of(list, sorted); });
        break;
      case Statistic::count:
        break;
    }
  }
}

}  // namespace pointsweep
