// SPDX-License-Identifier: MIT
/// Attributes taken from another cloud.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/change/take_work.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/kinds/results.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/nearest_names.h"

namespace pointsweep {
namespace {

constexpr double kMostPoints = 1000;
constexpr const char* kTakenMeaning = "taken from another cloud";

const OptionTable<TakeOptions>& take_options() {
  static const OptionTable<TakeOptions> table = {
      option("cloud", &TakeOptions::cloud, "the other cloud: a point file, a folder of them or a pattern",
             {.kind = OptionKind::file, .required = true, .positional = true, .sample = "labelled.las"}),
      option("attributes", &TakeOptions::attributes, "attributes of the other cloud, as in [classification, tree_id]",
             {.kind = OptionKind::attributes, .required = true, .sample = "classification"}),
      option("k", &TakeOptions::k, "so many nearest points of the other cloud give the value",
             {.least = 1, .most = kMostPoints}),
      option("vote", &TakeOptions::vote, "the value that they give: their majority, their mean, or that of the nearest",
             {.choices = {"majority", "mean", "nearest"}}),
      option("most", &TakeOptions::most,
             "maximum distance of a point that counts; without this option there is no limit",
             {.least = kAboveZero, .unit = "length", .sample = 5.0, .is_radius = true}),
      option("missing", &TakeOptions::missing,
             "value of points that have no point within 'most'; without this option they keep the value that they "
             "have, and new attributes are NaN",
             {.least = -std::numeric_limits<double>::infinity(), .sample = 0.0})};
  return table;
}

bool is_channel(const std::string& name) {
  const std::string word = library_name_of(name);
  return word == "red" || word == "green" || word == "blue";
}

/// Returns whether red, green and blue are single values, all of type uint8 or all of type uint16 by type_of_values().
bool has_colors(const Schema& schema) {
  std::vector<Type> types;
  for (const char* name : {"red", "green", "blue"}) {
    const auto at = schema.find(name);
    if (!at || schema.fields[*at].count != 1) return false;
    types.push_back(type_of_values(schema.fields[*at]));
  }
  return (types[0] == Type::u8 || types[0] == Type::u16) && types[1] == types[0] && types[2] == types[0];
}

/// Gives points the attributes of the nearest points of another cloud.
class Take final : public InOrderOperator {
 public:
  /// Messages about options in conflict begin with `place`. Throws UsageError for options out of range or in conflict,
  /// and for an attribute that is a coordinate or named twice.
  explicit Take(TakeOptions options, std::string place = "take");

  std::string name() const override { return "take"; }
  InOrderContract in_order_contract() const override;
  std::string other_cloud() const override { return rules_.options.cloud; }
  std::vector<Attribute> other_reads() const override {
    std::vector<Attribute> reads;
    for (const TakenAttribute& taken : rules_.taken) reads.push_back(taken.source);
    return reads;
  }
  std::optional<Reach> reach() const override { return Reach{}; }
  std::optional<Reach> other_reach() const override {
    return Reach{rules_.options.most.value_or(std::numeric_limits<double>::infinity()),
                 static_cast<std::size_t>(rules_.options.k)};
  }
  /// Throws UsageError for an attribute that the other cloud lacks, with the most similar names, and for a field that
  /// is an array or named twice.
  std::shared_ptr<const InOrderOperator> bound_to_other(const Schema& other) const override;
  /// Throws UsageError if an attribute of whole numbers cannot hold `missing`, if `most` without `missing` leaves a new
  /// attribute of whole numbers without a value for some points, or if a name means several values or two names the
  /// same attribute.
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override { return start_taking(rules_, setup); }
  std::uint64_t least_bytes(const CloudEstimate&) const override {
    return least_taking_bytes(rules_.options.k, bytes_of(other_reads()));
  }

 private:
  void find_target(TakenAttribute& taken, const Schema& input, std::span<const Attribute> made);
  void require_missing_value(const TakenAttribute& taken) const;

  TakeRules rules_;
};

}  // namespace

OperatorDeclaration take_declaration() {
  return {
      .name = "take",
      .meaning = "takes attributes from the nearest points of another cloud",
      .options = take_options().declarations(),
      .make = take_options().maker<Take>(),
      .formula =
          "v_1, ..., v_n: the values of the k points of the other cloud with the least (dx² + dy²) + dz² in float64, "
          "equal ones by x, y, z, then row, however far away they are; with `most` those of them with "
          "d² <= most · most.\n"
          "majority: the most frequent value; of several the one that the nearest point has\n"
          "mean:     the mean, of whole numbers from their exact sum, of others v_1 + 1/n Σ (v_j - v_1), in float64\n"
          "nearest:  v_1, with k=1\n"
          "Where n > 1, and for means, only finite values count.\n"
          "An attribute that the cloud has keeps its type. Whole numbers are exact; means are rounded to whole-number "
          "types, halves to even. Colours of 8 bits become those of 16 bits by 257, and back. A new attribute has the "
          "type that it has in the other cloud; means are float64, but those of colours.",
      .undefined =
          "Without a value, a point gets `missing`; without that option it keeps the value that it has, and a new "
          "attribute is NaN: then a new attribute of whole numbers is refused where there is `most`. A point without a "
          "finite place keeps its values; its new attributes are NaN, those of whole numbers 0. A value that the type "
          "of the attribute cannot hold ends the run with an error that names the row.",
      .cost =
          "a pass that puts the points in order along an axis; the other cloud is put in the same order in the "
          "temporary folder (32 bytes a point and those of its attributes, and as much while it is ordered), and "
          "memory holds what is near the front",
      .makes_named = true,
      .example = "take(labelled.las, attributes=classification, k=5)"};
}

ChainStage operators::take(const TakeOptions& options) { return std::make_shared<Take>(options); }

Take::Take(TakeOptions options, std::string place) : rules_{std::move(options), std::move(place)} {
  const TakeOptions& given = rules_.options;
  take_options().declare(*this, given);
  for (const std::string& name : given.attributes) {
    if (axis_of(name)) fail_usage("{}: '{}' is a coordinate; the points keep their places.", rules_.place, name);
    if (std::ranges::count(given.attributes, name) > 1) fail_usage("{}: '{}' is named twice.", rules_.place, name);
    rules_.taken.push_back({.name = name, .source = scalar(name, Type::f64, "1", "")});
    rules_.targets.push_back({nan_scalar(name, "1", kTakenMeaning), {}});
  }
  if (given.vote == TakeVote::nearest && given.k > 1)
    fail_usage("{}: vote=nearest takes the value of one point; leave out k={}, or let the points vote.", rules_.place,
               given.k);
  if (given.missing && !given.most)
    fail_usage("{}: missing is used only with most: without it every point has a nearest one.", rules_.place);
}

InOrderContract Take::in_order_contract() const {
  InOrderContract contract{.places = Places::of_operator, .arrival = "beside those of the other cloud"};
  for (const TakeTarget& target : rules_.targets) {
    if (target.old) contract.reads.push_back(*target.old);
    contract.makes.push_back(target.made);
  }
  return contract;
}

std::shared_ptr<const InOrderOperator> Take::bound_to_other(const Schema& other) const {
  auto bound = std::make_shared<Take>(*this);
  const std::string &place = rules_.place, &cloud = rules_.options.cloud;
  std::size_t from = 0;
  for (TakenAttribute& taken : bound->rules_.taken) {
    const auto at = field_meant(other, taken.name);
    if (!at) {
      std::vector<std::string> names;
      for (const Field& field : other.fields)
        if (!axis_of(field.name)) names.push_back(field.name);
      if (names.empty()) fail_usage("{}: {} has no attributes to take, only positions.", place, cloud);
      fail_usage("{}: {} has no attribute '{}'; the nearest it has {} {}.", place, cloud, taken.name,
                 names.size() == 1 ? "is" : "are", nearest_names(taken.name, names));
    }
    const Field& field = other.fields[*at];
    if (field.count != 1)
      fail_usage("{}: '{}' of {} is an array of {}, not a single value.", place, field.name, cloud, field.count);
    for (const TakenAttribute& before : std::span(bound->rules_.taken.data(), &taken))
      if (before.source.name == field.name)
        fail_usage("{}: '{}' and '{}' are the same attribute of {}.", place, before.name, taken.name, cloud);
    taken.source = scalar(field.name, type_of_values(field), "1", "");
    taken.is_color = has_colors(other) && is_channel(taken.name);
    taken.from = from;
    from += taken.source.bytes();
  }
  return bound;
}

std::shared_ptr<const InOrderOperator> Take::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<Take>(*this);
  bound->rules_.targets.clear();
  for (TakenAttribute& taken : bound->rules_.taken) bound->find_target(taken, input, made);
  for (TakenAttribute& taken : bound->rules_.taken) {
    const Attribute& a = bound->rules_.targets[taken.target].made;
    taken.to = taken.component * size_of(a.type);
    for (std::size_t t = 0; t < taken.target; ++t) taken.to += bound->rules_.targets[t].made.bytes();
    bound->require_missing_value(taken);
  }
  return bound;
}

/// Finds or makes the target of a taken value. Several components of an existing attribute share a target.
void Take::find_target(TakenAttribute& taken, const Schema& input, std::span<const Attribute> made) {
  TakeTarget target;
  if (std::optional<AssignedTarget> known = target_of(taken.name, input, made, rules_.place)) {
    target = {std::move(known->made), std::move(known->old)};
    taken.component = known->component, taken.range = known->range;
  } else {
    const bool is_mean = rules_.options.vote == TakeVote::mean && !taken.is_color;
    taken.range = range_of(is_mean ? Type::f64 : taken.source.type);
    target.made = taken.range.is_whole ? scalar(taken.name, taken.range.type, "1", kTakenMeaning)
                                       : nan_scalar(taken.name, "1", kTakenMeaning, taken.range.type);
    if (is_channel(taken.name)) target.made.kind = Kind::color;
  }
  // A later stage that scales the points also scales attributes whose unit is a length.
  if (target.made.unit == "1" && !range_of(target.made.type).is_whole) target.made.unit = unit_of_made(taken.name);
  const auto same =
      std::ranges::find(rules_.targets, target.made.name, [](const TakeTarget& t) { return t.made.name; });
  taken.target = static_cast<std::size_t>(same - rules_.targets.begin());
  if (same == rules_.targets.end()) rules_.targets.push_back(std::move(target));
  for (const TakenAttribute& before : std::span(rules_.taken.data(), &taken))
    if (before.target == taken.target && before.component == taken.component)
      fail_usage("{}: '{}' and '{}' are the same attribute of the points.", rules_.place, before.name, taken.name);
}

void Take::require_missing_value(const TakenAttribute& taken) const {
  const TargetRange& range = taken.range;
  const auto &missing = rules_.options.missing, &most = rules_.options.most;
  const bool fits = !range.is_whole || !missing ||
                    (std::nearbyint(*missing) == *missing && *missing >= range.least && *missing <= range.most);
  if (!fits) fail_usage("{}: missing={} is not {}, as '{}' is.", rules_.place, *missing, range.text(), taken.name);
  const bool is_new = !rules_.targets[taken.target].old.has_value();
  if (most && !missing && is_new && range.is_whole)
    fail_usage(
        "{0}: '{1}' is new, and {2} cannot say that a point has no other within most={3}; give missing=NUMBER for such "
        "points, or leave out most.",
        rules_.place, taken.name, name_of(range.type), *most);
}

}  // namespace pointsweep
