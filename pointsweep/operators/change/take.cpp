// SPDX-License-Identifier: MIT
#include "pointsweep/operators/change/take.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/change/take_work.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/meant_value.h"
#include "pointsweep/operators/rows/transform.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/nearest_names.h"

namespace pointsweep {
namespace {

constexpr double kMostPoints = 1000;

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

bool is_real(Type type) { return type == Type::f32 || type == Type::f64; }

bool is_channel(const std::string& name) {
  const std::string word = library_name_of(name);
  return word == "red" || word == "green" || word == "blue";
}

/// Returns whether red, green and blue all have 8 or all have 16 bits, as whole fields or as bits of a packed field.
bool has_colors(const Schema& schema) {
  std::vector<Type> types;
  for (const char* name : {"red", "green", "blue"}) {
    const auto at = schema.find(name);
    if (!at || schema.fields[*at].count != 1) return false;
    types.push_back(type_of_values(schema.fields[*at]));
  }
  return (types[0] == Type::u8 || types[0] == Type::u16) && types[1] == types[0] && types[2] == types[0];
}

bool is_coordinate(const std::string& name) {
  const std::string word = library_name_of(name);
  return std::ranges::find(kAxisNames, word) != kAxisNames.end();
}

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
          "memory "
          "holds what is near the front",
      .makes_named = true,
      .example = "take(labelled.las, attributes=classification, k=5)"};
}

ChainStage operators::take(const TakeOptions& options) { return std::make_shared<Take>(options); }

Take::Take(TakeOptions options, std::string place) : options_(std::move(options)), place_(std::move(place)) {
  take_options().declare(*this, options_);
  for (const std::string& name : options_.attributes) {
    if (is_coordinate(name)) fail_usage("{}: '{}' is a coordinate; the points keep their places.", place_, name);
    if (std::ranges::count(options_.attributes, name) > 1) fail_usage("{}: '{}' is named twice.", place_, name);
    taken_.push_back({.name = name, .source = scalar(name, Type::f64, "1", "")});
    Attribute made = scalar(name, Type::f64, "1", "taken from another cloud");
    made.fill = std::byte{0xff};  // NaN
    targets_.push_back({made, {}});
  }
  if (options_.vote == TakeVote::nearest && options_.k > 1)
    fail_usage("{}: vote=nearest takes the value of one point; leave out k={}, or let the points vote.", place_,
               options_.k);
  if (options_.missing && !options_.most)
    fail_usage("{}: missing is used only with most: without it every point has a nearest one.", place_);
}

InOrderContract Take::in_order_contract() const {
  InOrderContract contract{.places = Places::of_operator, .arrival = "beside those of the other cloud"};
  for (const TakeTarget& target : targets_) {
    if (target.old) contract.reads.push_back(*target.old);
    contract.makes.push_back(target.made);
  }
  return contract;
}

std::optional<Reach> Take::other_reach() const {
  return Reach{options_.most.value_or(std::numeric_limits<double>::infinity()), static_cast<std::size_t>(options_.k)};
}

std::vector<Attribute> Take::other_reads() const {
  std::vector<Attribute> reads;
  for (const TakenAttribute& taken : taken_) reads.push_back(taken.source);
  return reads;
}

std::shared_ptr<const InOrderOperator> Take::bound_to_other(const Schema& other) const {
  auto bound = std::make_shared<Take>(*this);
  std::size_t from = 0;
  for (TakenAttribute& taken : bound->taken_) {
    const auto at = field_meant(other, taken.name);
    if (!at) {
      std::vector<std::string> names;
      for (const Field& field : other.fields)
        if (!is_coordinate(field.name)) names.push_back(field.name);
      if (names.empty()) fail_usage("{}: {} has no attributes to take, only positions.", place_, options_.cloud);
      fail_usage("{}: {} has no attribute '{}'; the nearest it has {} {}.", place_, options_.cloud, taken.name,
                 names.size() == 1 ? "is" : "are", nearest_names(taken.name, names));
    }
    const Field& field = other.fields[*at];
    if (field.count != 1)
      fail_usage("{}: '{}' of {} is an array of {}, not a single value.", place_, field.name, options_.cloud,
                 field.count);
    for (const TakenAttribute& before : std::span(bound->taken_.data(), &taken))
      if (before.source.name == field.name)
        fail_usage("{}: '{}' and '{}' are the same attribute of {}.", place_, before.name, taken.name, options_.cloud);
    taken.source = scalar(field.name, type_of_values(field), "1", "");
    taken.is_color = has_colors(other) && is_channel(taken.name);
    taken.from = from;
    from += taken.source.bytes();
  }
  return bound;
}

std::shared_ptr<const InOrderOperator> Take::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<Take>(*this);
  bound->targets_.clear();
  for (TakenAttribute& taken : bound->taken_) bound->find_target(taken, input, made);
  for (TakenAttribute& taken : bound->taken_) {
    const Attribute& a = bound->targets_[taken.target].made;
    taken.to = taken.component * size_of(a.type);
    for (std::size_t t = 0; t < taken.target; ++t) taken.to += bound->targets_[t].made.bytes();
    bound->require_missing_value(taken);
  }
  return bound;
}

/// Finds or makes the target of a taken value. Several components of an existing attribute share a target.
void Take::find_target(TakenAttribute& taken, const Schema& input, std::span<const Attribute> made) {
  TakeTarget target;
  if (std::optional<AssignedTarget> known = target_of(taken.name, input, made, place_)) {
    target = {std::move(known->made), std::move(known->old)};
    taken.component = known->component, taken.range = known->range;
  } else {
    const bool is_mean = options_.vote == TakeVote::mean && !taken.is_color;
    taken.range = range_of(is_mean ? Type::f64 : taken.source.type);
    target.made = scalar(taken.name, taken.range.type, "1", "taken from another cloud");
    if (is_channel(taken.name)) target.made.kind = Kind::color;
    if (is_real(target.made.type)) target.made.fill = std::byte{0xff};  // NaN
  }
  // Lengths from another cloud must be scaled, too, if a later stage scales the points.
  if (target.made.unit == "1" && is_real(target.made.type)) target.made.unit = unit_of_made(taken.name);
  const auto same = std::ranges::find(targets_, target.made.name, [](const TakeTarget& t) { return t.made.name; });
  taken.target = static_cast<std::size_t>(same - targets_.begin());
  if (same == targets_.end()) targets_.push_back(std::move(target));
  for (const TakenAttribute& before : std::span(taken_.data(), &taken))
    if (before.target == taken.target && before.component == taken.component)
      fail_usage("{}: '{}' and '{}' are the same attribute of the points.", place_, before.name, taken.name);
}

void Take::require_missing_value(const TakenAttribute& taken) const {
  const TargetRange& range = taken.range;
  const bool fits = !range.is_whole || !options_.missing ||
                    (std::nearbyint(*options_.missing) == *options_.missing && *options_.missing >= range.least &&
                     *options_.missing <= range.most);
  if (!fits) fail_usage("{}: missing={} is not {}, as '{}' is.", place_, *options_.missing, range.text(), taken.name);
  const bool is_new = !targets_[taken.target].old.has_value();
  if (options_.most && !options_.missing && is_new && range.is_whole)
    fail_usage(
        "{0}: '{1}' is new, and {2} cannot say that a point has no other within most={3}; give missing=NUMBER for such "
        "points, or leave out most.",
        place_, taken.name, name_of(range.type), *options_.most);
}

std::unique_ptr<InOrderWork> Take::start(const InOrderSetup& setup) const {
  return start_taking({options_, place_, taken_, targets_}, setup);
}

std::uint64_t Take::least_bytes(const CloudEstimate&) const {
  return least_taking_bytes(options_.k, bytes_of(other_reads()));
}

}  // namespace pointsweep
