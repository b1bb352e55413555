// SPDX-License-Identifier: MIT
#include "pointsweep/verify/verify.h"

#include <algorithm>
#include <set>

#include "pointsweep/fail.h"
#include "pointsweep/verify/chain_values.h"
#include "pointsweep/verify/rows/row_alignment.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kSubset = 65536;

/// Returns the rows of the sample and the rows that the user has named, ascending.
std::vector<std::uint64_t> rows_to_check(std::uint64_t count, const VerifyOptions& options,
                                         const RowAlignment* alignment = nullptr) {
  std::vector<std::uint64_t> rows = alignment != nullptr
                                        ? sample_of_both(*alignment, count, options.sample, options.seed)
                                        : sample_rows(count, options.sample, options.seed);
  for (const std::uint64_t row : options.rows)
    if (row >= count) fail_usage("Row {} is to be checked, and the input has {} rows, numbered from 0.", row, count);
  rows.insert(rows.end(), options.rows.begin(), options.rows.end());
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

class Verification {
 public:
  Verification(InputCloud& in, RowSource& out, bool is_array, const MadeBy& made_by, const VerifyOptions& options)
      : in_(in),
        stored_in_(made_by.loses_nonfinite ? RowSource::without_nonfinite(in_) : in_),
        out_(out),
        made_by_(made_by),
        options_(options),
        chain_(made_by.operators, made_by.keep, in_.schema(), made_by.rule, made_by.outlier_threshold),
        rows_(rows_to_check(in_.count(), options)),
        made_values_(out),
        differences_(made_by.known) {
    verdict_.input = in_.name(), verdict_.output = out_.name();
    verdict_.attributes_compared = !is_array;
    verdict_.untold = made_by.untold;
    for (std::size_t a = 0; a < chain_.made().size(); ++a) {
      if (!ChainValues::is_selection(chain_.made()[a])) verdict_.made.push_back(chain_.made()[a].name);
      if (!chain_.is_independent(a)) verdict_.by_own_operator.push_back(chain_.made()[a].name);
    }
  }

  Verdict run() {
    pair_made_attributes();
    if (!made_by_.leaves_out || find_kept_rows()) {
      compare();
      judge_arrivals();
      const bool is_made = !made_values_.empty() || !selections_.empty();
      if (verdict_.arrivals.points_in == verdict_.arrivals.points_out && !order_is_lost_ && is_made) check_sample();
    }
    verdict_.difference_count = differences_.count;
    verdict_.differences = std::move(differences_.sentences);
    return std::move(verdict_);
  }

 private:
  void pair_made_attributes() {
    const Schema results = schema_of_made(chain_.made(), options_.prefix);
    replaced_.assign(in_.schema().fields.size(), !verdict_.attributes_compared);
    for (std::size_t f = 0; f < replaced_.size(); ++f)
      if (made_by_.left_out_input.contains(in_.schema().fields[f].name)) replaced_[f] = true;
    std::size_t f = 0, estimate = 0;
    for (const Attribute& a : chain_.made()) {
      if (ChainValues::is_selection(a)) {
        selections_.push_back(estimate++), ++f;
        continue;
      }
      const std::size_t width = a.fields.size() / estimates_of(a);  // number of components of an estimate
      for (std::size_t e = 0; e < estimates_of(a); ++e, f += width) pair_made_value(results, f, width, estimate++);
    }
    for (const Attribute& a : made_by_.unchecked) {
      verdict_.unknown.push_back(a.name);
      for (const std::string& name : a.fields)
        if (const auto old = in_.schema().find(name)) replaced_[*old] = true;
    }
    const std::set<std::string> paired = paired_fields(results);
    std::vector<std::string> others;
    for (const Field& field : out_.schema().fields)
      if (!paired.contains(field.name) && !is_field_of(in_.schema(), field.name) && !is_field_of(results, field.name) &&
          std::ranges::find(verdict_.unknown, field.name) == verdict_.unknown.end())
        others.push_back(field.name);
    const std::vector<std::string> unfilled = unfilled_fields(out_, others, made_by_.own_field);
    for (const std::string& name : others)
      if (std::ranges::find(unfilled, name) == unfilled.end()) verdict_.unknown.push_back(name);
  }

  /// Returns the names of the fields of the output that hold values of the input or of `results`.
  std::set<std::string> paired_fields(const Schema& results) const {
    std::set<std::string> names;
    for (const Schema* schema : {&in_.schema(), &results})
      for (std::size_t f = 0; f < schema->fields.size(); ++f)
        if (const auto pairs = pairs_in_output(*schema, f))
          for (const FieldPair& pair : *pairs) names.insert(pair.name_in_output());
    return names;
  }

  void pair_made_value(const Schema& results, std::size_t first, std::size_t width, std::size_t estimate) {
    std::vector<std::optional<FieldPair>> pairs(width);  // absent for a component that was not written
    for (std::size_t c = 0; c < width; ++c) {
      const std::string& name = results.fields[first + c].name;
      if (made_by_.left_out_made.contains(name)) continue;
      if (const auto old = in_.schema().find(name)) replaced_[*old] = true;
      if (const auto found = pairs_in_output(results, first + c))
        pairs[c] = found->front();
      else
        differences_.add("the output has no '{}', which is to be made", name);
    }
    if (std::ranges::any_of(pairs, [](const auto& pair) { return pair.has_value(); }))
      made_values_.add(estimate, MadeValue(std::move(pairs)));
  }

  /// Pairs the fields of the input with their copies in the output, by which rows of the output are recognized.
  void pair_known_fields() {
    std::vector<FieldPair> known;
    for (std::size_t f = 0; f < replaced_.size(); ++f)
      if (!replaced_[f])
        if (const auto pairs = pairs_in_output(in_.schema(), f))
          known.insert(known.end(), pairs->begin(), pairs->end());
    if (known.empty())
      fail_usage("verify: {} holds nothing of the input, by which its rows are recognized.", out_.name());
    known_.emplace(stored_in_, out_, made_by_.in_any_order, std::move(known));
  }

  /// Matches the rows of the output with rows of the input. Returns false if the output is not a selection of the
  /// input's rows in the order of the input.
  bool find_kept_rows() {
    pair_known_fields();
    alignment_ = align_rows(stored_in_, out_, *known_, options_.progress);
    verdict_.left_out = in_.count() - alignment_->kept.size();
    verdict_.arrivals.points_in = in_.count(), verdict_.arrivals.points_out = out_.count();
    rows_ = rows_to_check(in_.count(), options_, &*alignment_);
    ++verdict_.passes;
    if (!alignment_->not_of_input) return true;
    differences_.add("row {} is not a row of the input, or not in its order", *alignment_->not_of_input);
    return false;
  }

  /// Reads all points: compares all values, unless the output is an array, and stores the positions of the sample and
  /// of a thin subset.
  void compare() {
    const std::uint64_t stride = std::max<std::uint64_t>(1, in_.count() / kSubset);
    std::size_t next = 0;
    const auto look = [&](std::uint64_t row, Vec3 p) {
      const bool finite = is_finite(p);
      if (finite && row % stride == 0) subset_.push_back({p, row});
      if (next == rows_.size() || rows_[next] != row) return;
      ++next;
      finite ? void(finite_.push_back({p, row})) : void(nonfinite_.push_back({p, row}));
    };
    ++verdict_.passes;
    if (alignment_) {
      for_each_position(in_, "reading", options_.progress, look);
      RowSource kept(stored_in_, alignment_->kept);
      verdict_.arrivals =
          compare_arrivals(kept, out_, replaced_, ways(), options_.progress, [](std::uint64_t, Vec3) {});
      return;
    }
    if (verdict_.attributes_compared) {
      verdict_.arrivals = compare_arrivals(stored_in_, out_, replaced_, ways(), options_.progress, look);
      return;
    }
    verdict_.arrivals.points_in = in_.count(), verdict_.arrivals.points_out = out_.count();
    for_each_position(in_, "reading", options_.progress, look);
  }

  void judge_arrivals() {
    const Arrivals& a = verdict_.arrivals;
    for (const std::string& name : a.missing) differences_.add("the output lacks the attribute '{}'", name);
    if (a.points_in != a.points_out) differences_.add("{} points came out of {}", a.points_out, a.points_in);
    if (!verdict_.attributes_compared) {
      verdict_.order = "input";
    } else if (made_by_.in_any_order) {
      judge_values_in_any_order();
      verdict_.order = "files of the output";
    } else if (sweep_is_meant()) {
      judge_values_in_any_order();
      judge_sweep_order();
    } else {
      verdict_.order = "input";
      judge_row_by_row();
      if (!options_.order && a.rows_different > a.points_in / 2) verdict_.order.clear();
    }
  }

  /// Returns whether the output is in the order of a sweep. If the options state no order, returns true if the rows
  /// seem to be the rows of the input in another order.
  bool sweep_is_meant() const {
    const Arrivals& a = verdict_.arrivals;
    if (options_.order) return *options_.order == Order::sweep;
    const bool most_differ = std::ranges::any_of(
        a.attributes, [&](const AttributeArrival& one) { return one.rows_different > a.points_in / 2; });
    return !a.row_by_row() &&
           (a.in_some_order() || (most_differ && a.ascending[static_cast<std::size_t>(a.bounds.longest_axis())]));
  }

  void judge_row_by_row() {
    const Arrivals& a = verdict_.arrivals;
    if (a.points_in != a.points_out && !a.attributes.empty())
      differences_.add("row {} is the first that is not the same in both", *a.first_different);
    if (a.points_in == a.points_out) verdict_.different_rows = a.rows_different;
    for (const AttributeArrival& one : a.attributes) {
      if (one.rows_different == 0 || a.points_in != a.points_out) continue;
      differences_.add("row {}: {} is {}, but {} in the input ({} such {})", one.first_different, one.name, one.found,
                       one.expected, one.rows_different, one.rows_different == 1 ? "row" : "rows");
    }
  }

  void judge_values_in_any_order() {
    const Arrivals& a = verdict_.arrivals;
    bool sums_tell = false;
    for (const AttributeArrival& one : a.attributes) {
      if (one.sum_in == one.sum_out) continue;
      differences_.add("the values of {} are not those of the input", one.name);
      sums_tell = true;
    }
    if (!sums_tell && a.sum_in != a.sum_out && a.points_in == a.points_out)
      differences_.add("all values are there, but not all with the points they belong to");
  }

  void judge_sweep_order() {
    const Arrivals& a = verdict_.arrivals;
    axis_ = options_.axis ? *options_.axis : a.bounds.longest_axis();
    verdict_.order = fmt::format("sweep along {}", "xyz"[axis_]);
    if (moved() || a.ascending[static_cast<std::size_t>(axis_)]) return;
    verdict_.order.clear();
    if (!options_.order && verdict_.made.empty() && selections_.empty())
      return;  // the rows were made by no run that would order them
    differences_.add("the rows ascend neither as those of the input nor along {}", "xyz"[axis_]);
    order_is_lost_ = true;
  }

  bool moved() const {
    const auto x = in_.schema().find("x");
    return x && replaced_[*x];
  }

  void check_sample() {
    std::vector<PossibleRows> places;  // for each row of the sample, the rows of the output with its values
    if (made_by_.in_any_order) {
      pair_known_fields();
      auto found = rows_with_values(stored_in_, out_, *known_, rows_, options_.progress);
      if (!found) return;  // the output lacks a row of the sample, which is reported as a difference of the values
      places = std::move(*found), ++verdict_.passes;
      if (moved() && std::ranges::any_of(places, [](const PossibleRows& any) { return any.count > 1; }))
        return verdict_.untold.push_back(
            "what stages made of moved points: the output has them in another order, and the attributes that they keep "
            "do not tell all of them apart");
    } else {
      if (axis_ >= 0) ++verdict_.passes;
      for (const std::uint64_t row : axis_ >= 0 ? sweep_rows(in_, rows_, axis_, options_.progress) : rows_)
        places.push_back({{row}, 1});
    }
    CloudRows rows(in_, out_, axis_, options_.memory_bytes, options_.progress, !alignment_ && !made_by_.in_any_order);
    for (std::string& untold :
         chain_.look_at_cloud(rows, made_by_.neighborhood, made_by_.before_means.get(), columns_of_output()))
      verdict_.untold.push_back(std::move(untold));
    drop_untold();
    const std::size_t turn = points_in_a_turn();
    for (std::size_t first = 0; first < finite_.size(); first += turn) {
      const auto chosen = std::span(finite_).subspan(first, std::min(turn, finite_.size() - first));
      Surroundings around =
          find_surroundings(in_, chosen, subset_, made_by_.neighborhood, chain_.rings(), options_.progress);
      verdict_.passes += chain_.rings();
      hold_against_output(chosen, chain_.evaluate(std::move(around), in_, rows), places);
    }
    verdict_.passes += rows.passes();
    hold_against_output(nonfinite_, chain_.evaluate_unplaced(nonfinite_, in_), places);
    judge_suspects();
    if (unclear_ > 0)
      verdict_.untold.push_back(
          fmt::format("what stages made of {} points of the sample: the output has more than {} points that equal each "
                      "of them, and "
                      "in another order",
                      unclear_, kMostPossibleRows));
  }

  /// Returns a function that finds the fields of a made attribute in the output. If the attribute was not written, a
  /// field with its name comes from the input and is not returned.
  OutputColumns columns_of_output() const {
    return [this](const Attribute& made) -> std::optional<std::vector<FieldPair>> {
      if (std::ranges::find(chain_.made(), made.name, &Attribute::name) == chain_.made().end()) return std::nullopt;
      const Schema schema = schema_of_made({made}, options_.prefix);
      std::vector<FieldPair> pairs;
      for (std::size_t f = 0; f < schema.fields.size(); ++f) {
        if (made_by_.left_out_made.contains(schema.fields[f].name)) return std::nullopt;
        const auto found = pairs_in_output(schema, f);
        if (!found) return std::nullopt;
        pairs.push_back(found->front());
      }
      return pairs;
    };
  }

  /// Removes the attributes that cannot be checked.
  void drop_untold() {
    std::vector<bool> told;  // for each estimate, true if it can be checked
    verdict_.made.clear();
    for (std::size_t a = 0; a < chain_.made().size(); ++a) {
      told.insert(told.end(), estimates_of(chain_.made()[a]), chain_.is_told(a));
      if (chain_.is_told(a) && !ChainValues::is_selection(chain_.made()[a]))
        verdict_.made.push_back(chain_.made()[a].name);
    }
    made_values_.keep(told);
  }

  /// Estimates the number of points that fit in memory with their surroundings. Assumes that neighbourhoods overlap
  /// like those of points that fill a volume.
  std::size_t points_in_a_turn() const {
    const double k = made_by_.neighborhood.k == NeighborRule::kUnlimited
                         ? 256
                         : static_cast<double>(std::min<std::uint64_t>(made_by_.neighborhood.k, in_.count()));
    double lists = 1, all = 1;
    for (std::size_t ring = 1; ring < chain_.rings(); ++ring) {
      const double r = static_cast<double>(ring);
      all = std::min(all * k, r * r * r * k);
      lists += all;
    }
    const double bytes = lists * ((k + 1) * 64 + static_cast<double>(chain_.bytes_per_point())) + 200;
    return std::max<std::size_t>(1, static_cast<std::size_t>(static_cast<double>(options_.memory_bytes) / bytes));
  }

  /// Compares results with the output. `points`: a part of the sample in ascending order of rows; `results` has one
  /// record for each point; `places`: for each row of the whole sample, the possible rows of the output.
  void hold_against_output(std::span<const KnownPoint> points, const ChainResults& results,
                           const std::vector<PossibleRows>& places) {
    struct Wanted {
      std::uint64_t place;
      std::size_t point;
    };
    const std::size_t estimates_per_point = chain_.estimates_per_point();
    const auto estimates_of_point = [&](std::size_t i) { return results.estimates.data() + i * estimates_per_point; };
    std::vector<Wanted> wanted;
    std::vector<char> is_clear(points.size(), true);  // false if PossibleRows::rows does not list all possible rows
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (alignment_) {
        check_selection(points[i].row, estimates_of_point(i));
        if (const auto place = alignment_->place_of(points[i].row)) wanted.push_back({*place, i});
        continue;
      }
      const PossibleRows& possible =
          places[static_cast<std::size_t>(std::ranges::lower_bound(rows_, points[i].row) - rows_.begin())];
      is_clear[i] = possible.rows.size() == possible.count;
      for (const std::uint64_t place : possible.rows) wanted.push_back({place, i});
    }
    std::ranges::sort(wanted, {}, &Wanted::place);
    std::vector<std::uint64_t> ascending;
    for (const Wanted& w : wanted) ascending.push_back(w.place);
    // At least one of the possible rows of a point must have the right values.
    std::vector<std::optional<std::string>> difference(points.size());
    std::vector<char> is_right(points.size(), false);
    for_each_record(out_, ascending, [&](std::size_t i, const std::byte* record) {
      const auto& [place, point] = wanted[i];
      if (is_right[point]) return;
      const auto found =
          made_values_.difference_at(place, points[point].row, results.values.data() + point * chain_.result_bytes(),
                                     estimates_of_point(point), record);
      if (!found) is_right[point] = true;
      if (!difference[point]) difference[point] = found;
    });
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!is_right[i] && !difference[i]) continue;  // the output has dropped the point
      verdict_.values += made_values_.size();
      verdict_.open_values += made_values_.open_values(estimates_of_point(i));
      if (!is_right[i]) is_clear[i] ? suspect(points[i].row, *difference[i]) : void(++unclear_);
    }
    verdict_.sampled += points.size();
  }

  OutputWays ways() const {
    return {made_by_.own_field,
            made_by_.stored_name,
            {options_.decimals, options_.positions == Type::f32},
            made_by_.in_any_order};
  }

  std::optional<std::vector<FieldPair>> pairs_in_output(const Schema& schema, std::size_t field) const {
    return pairs_of_field(schema, field, out_.schema(), ways().places, made_by_.stored_name);
  }

  /// Checks that the output has a row of the input if and only if all conditions hold for the row.
  void check_selection(std::uint64_t row, const formulas::Estimate* estimates) {
    bool told = true, stays = true;
    for (const std::size_t s : selections_) {
      told = told && !estimates[s].is_open();
      stays = stays && (estimates[s].is_open() || estimates[s].value.x != 0);
    }
    const bool has = alignment_->has(row);
    if (stays && (!told || (made_by_.leaves_out_more && !has)))
      ++verdict_.open_rows;
    else if (stays != has)
      suspect(row, fmt::format("row {} of the input {}", row,
                               stays ? "is left out, and the conditions hold for it"
                                     : "is in the output, and a condition does not hold for it"));
  }

  void suspect(std::uint64_t row, std::string difference) { suspects_.emplace_back(row, std::move(difference)); }

  /// Decides which suspects are differences. If two different rows of the input become equal in the precision of the
  /// output, and only one was kept, the output does not show which one. Such rows count as open, not as different.
  void judge_suspects() {
    std::ranges::stable_sort(suspects_, {}, [](const auto& s) { return s.first; });
    std::vector<std::uint64_t> rows, twins;
    for (const auto& [row, difference] : suspects_)
      if (rows.empty() || rows.back() != row) rows.push_back(row);
    if (alignment_ && !rows.empty())
      twins = rows_with_twins(stored_in_, *alignment_, *known_, rows, options_.progress), ++verdict_.passes;
    for (const auto& [row, difference] : suspects_)
      if (!std::ranges::binary_search(twins, row)) differences_.add("{}", difference);
    verdict_.wrong_points = rows.size() - twins.size();
    verdict_.open_rows += twins.size();
  }

  RowSource in_;
  RowSource stored_in_;  ///< the input with the coordinates that the format of the output can hold
  RowSource& out_;
  const MadeBy& made_by_;
  const VerifyOptions& options_;
  ChainValues chain_;
  std::vector<std::uint64_t> rows_;             ///< rows of the sample, ascending
  std::vector<KnownPoint> finite_, nonfinite_;  ///< points of the sample
  std::vector<KnownPoint> subset_;              ///< points at evenly spaced rows of the cloud
  std::vector<bool> replaced_;                  ///< for each field of the input, true if it is not compared
  MadeValues made_values_;
  Differences differences_;
  std::vector<std::size_t> selections_;    ///< numbers of the estimates of conditions
  std::optional<RowAlignment> alignment_;  ///< present if the output lacks rows
  /// Fields that identify the rows of an output that lacks rows of the input or has them in any order.
  std::optional<FilePairs> known_;
  std::vector<std::pair<std::uint64_t, std::string>> suspects_;  ///< rows that seem to be wrong, with the reason
  int axis_ = -1;  ///< axis of the sweep in whose order the rows are; negative for any other order
  bool order_is_lost_ = false;
  /// Number of points of the sample that equal more than kMostPossibleRows rows, of which none compared is right.
  std::uint64_t unclear_ = 0;
  Verdict verdict_;
};

}  // namespace

Verdict verify(InputCloud& in, RowSource& out, bool is_array, const MadeBy& made_by, const VerifyOptions& options) {
  MadeBy known = made_by;
  known.operators = with_input_values(std::move(known.operators), in);
  if (known.leaves_out || makes_distances_again(known.operators)) {
    try {
      known.outlier_threshold =
          outlier_threshold_of_all(in, known.operators, known.rule, known.neighborhood, options.memory_bytes);
    } catch (const NotTold& why) {
      known.untold.push_back(fmt::format("outlier: the mean distance of all points {}", why.what()));
    }
  }
  return Verification(in, out, is_array, known, options).run();
}

}  // namespace pointsweep
