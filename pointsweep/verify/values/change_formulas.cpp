// SPDX-License-Identifier: MIT
/// Formulas of the operators that read another cloud: distance_to, m3c2 and take.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/quantities.h"
#include "pointsweep/verify/formulas/cylinder.h"
#include "pointsweep/verify/formulas/neighbor_statistics.h"
#include "pointsweep/verify/search/nearest_in_stream.h"
#include "pointsweep/verify/values/cloud_formula.h"
#include "pointsweep/verify/values/stored_values.h"

namespace pointsweep {
namespace {

using formulas::Estimate;
using formulas::Real;

/// Opens another cloud without comparing the coordinate reference systems of its files, because the run has compared
/// them unless --ignore-crs was given.
std::unique_ptr<InputCloud> opened(const std::string& name) { return opened_cloud(name, true); }

PointsOfCloud points_of(RowSource& source, const PhaseProgress& progress) {
  return [&](const auto& take) { for_each_position(source, "comparing", progress, take); };
}

class NearestDistance final : public CloudFormula {
 public:
  explicit NearestDistance(const FormulaSetup& stage)
      : other_(opened(stage.options.word("cloud"))),
        most_(stage.options.number_if_given("most").value_or(std::numeric_limits<double>::infinity())) {}
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    const std::vector<Vec3> places = positions_of(points);
    RowSource source(*other_);
    const auto nearest =
        nearest_of_cloud(places, points_of(source, in.rows.progress()), source.count(), {.reach2 = most_ * most_});
    std::vector<Estimates> made;
    for (const auto& found : nearest)
      made.push_back({formulas::exactly(found.empty() ? formulas::kNaN : std::sqrt(found.front().distance2))});
    return made;
  }

 private:
  std::unique_ptr<InputCloud> other_;
  double most_;
};

class ChangeAlongNormals final : public CloudFormula {
 public:
  explicit ChangeAlongNormals(const FormulaSetup& stage)
      : other_(opened(stage.options.word("cloud"))),
        cylinder_(stage.options.number("cylinder")),
        depth_(stage.options.number("depth")),
        registration_(stage.options.number("registration")) {}
  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    RowSource other(*other_);
    const auto before = filled(points, in.rows.input(), in.rows.progress());
    const auto after = filled(points, other, in.rows.progress());
    std::vector<Estimates> made;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto c = formulas::change(before[i], after[i], registration_, points[i].reads[0].either_sign);
      made.push_back({c.distance, c.level, c.spread1, c.spread2, c.samples1, c.samples2});
    }
    return made;
  }

 private:
  std::vector<formulas::Cylinder> filled(std::span<const CloudPoint> points, RowSource& cloud,
                                         const PhaseProgress& progress) const {
    std::vector<formulas::Cylinder> cylinders;
    std::vector<Vec3> centers;
    std::vector<double> reach2;
    for (const CloudPoint& p : points) {
      const Vec3 c = p.at.position;
      cylinders.emplace_back(formulas::Vector{c.x, c.y, c.z}, p.reads[0], cylinder_, depth_);
      centers.push_back(c);
      reach2.push_back(static_cast<double>(cylinders.back().reach2()));
    }
    const BallIndex balls(centers, reach2);
    for_each_position(cloud, "comparing", progress, [&](std::uint64_t, Vec3 p) {
      if (!is_finite(p)) return;
      balls.visit(p, [&](std::uint32_t i) {
        if (distance2(centers[i], p) <= reach2[i]) cylinders[i].add({p.x, p.y, p.z});
      });
    });
    return cylinders;
  }

  std::unique_ptr<InputCloud> other_;
  double cylinder_, depth_, registration_;
};

bool is_real(Type type) { return storage_of(type) != formulas::Storage::whole; }

class TakenValues final : public CloudFormula {
 public:
  explicit TakenValues(const FormulaSetup& stage)
      : other_(opened(stage.options.word("cloud"))),
        contract_(stage.contract),
        vote_(stage.options.word("vote")),
        missing_(stage.options.number_if_given("missing")),
        query_{.most = static_cast<std::size_t>(stage.options.whole("k"))} {
    if (const auto most = stage.options.number_if_given("most")) query_.reach2 = *most * *most;
    for (const std::string& name : parse_names("attributes", stage.options.word("attributes"))) {
      const std::size_t field = field_meant(other_->schema(), name).value();
      taken_.push_back({field, type_of_values(other_->schema().fields[field]), read_of(name, contract_.makes)});
    }
  }

  std::vector<Estimates> evaluate(std::span<const CloudPoint> points, const CloudInput& in) override {
    const std::vector<Vec3> places = positions_of(points);
    RowSource source(*other_);
    const auto nearest = nearest_of_cloud(places, points_of(source, in.rows.progress()), source.count(), query_);
    const std::map<std::uint64_t, std::vector<Real>> values = values_of(nearest, source);
    std::vector<Estimates> made;
    for (std::size_t i = 0; i < points.size(); ++i) {
      std::vector<const std::vector<Real>*> found;
      for (const NearPoint& near : nearest[i]) found.push_back(&values.at(near.row));
      made.push_back(given_to(points[i], found));
    }
    return made;
  }

 private:
  struct Taken {
    std::size_t field;  ///< field of the other cloud
    Type type;
    ReadValue target;  ///< component of a made attribute that gets the value
  };

  /// Returns the taken values of the rows that were found, by row.
  std::map<std::uint64_t, std::vector<Real>> values_of(const std::vector<std::vector<NearPoint>>& nearest,
                                                       RowSource& source) const {
    std::map<std::uint64_t, std::vector<Real>> values;
    for (const auto& found : nearest)
      for (const NearPoint& near : found) values[near.row];
    std::vector<std::uint64_t> rows;
    for (const auto& [row, none] : values) rows.push_back(row);
    for_each_record(source, rows, [&](std::size_t i, const std::byte* record) {
      for (const Taken& taken : taken_) {
        std::byte bytes[8];
        put_value(source.schema().fields[taken.field], record, taken.type, bytes);
        values[rows[i]].push_back(number_in(taken.type, bytes));
      }
    });
    return values;
  }

  Estimates given_to(const CloudPoint& point, const std::vector<const std::vector<Real>*>& found) const {
    Estimates made = values_before(point);
    for (std::size_t t = 0; t < taken_.size(); ++t) {
      std::vector<Real> values;
      for (const auto* of_point : found) values.push_back((*of_point)[t]);
      const Taken& taken = taken_[t];
      std::optional<Estimate> value = formulas::voted(vote_, values, !is_real(taken.type));
      const auto target = static_cast<std::size_t>(taken.target.attribute);
      const Type type = contract_.makes[target].type;
      if (value && brightness(taken, type) != 1) {
        value->value.x *= brightness(taken, type), value->error *= brightness(taken, type);
        if (!is_real(type)) value = formulas::stored(*value, formulas::Storage::whole);
      }
      if (!value && missing_) value = formulas::exactly(*missing_);
      if (!value) continue;
      const Estimate stored = formulas::stored(*value, storage_of(type));
      Estimate& own = made[target];
      if (taken.target.component > 2) continue;
      own.value[taken.target.component] = stored.value.x;
      own.error += stored.error;
    }
    return made;
  }

  /// Returns the values of the point before the stage; for new attributes NaN, or 0 if the attribute is an integer.
  Estimates values_before(const CloudPoint& point) const {
    Estimates made;
    for (const Attribute& a : contract_.makes) {
      const auto read = std::ranges::find(contract_.reads, a.name, &Attribute::name);
      if (read != contract_.reads.end())
        made.push_back(point.reads[static_cast<std::size_t>(read - contract_.reads.begin())]);
      else
        made.push_back(formulas::exactly(is_real(a.type) ? formulas::kNaN : 0));
      if (a.fields.size() > 3) throw NotTold("it changes a part of a long list");
    }
    return made;
  }

  /// Returns the factor that converts a colour channel of the other cloud between u8 and u16; 1 for all other values.
  Real brightness(const Taken& taken, Type type) const {
    const Schema& schema = other_->schema();
    const std::string own = library_name_of(schema.fields[taken.field].name);
    const std::string channels[] = {"red", "green", "blue"};
    if (std::ranges::find(channels, own) == std::end(channels)) return 1;
    for (const std::string& channel : channels) {
      const auto at = schema.find(channel);
      if (!at || type_of_values(schema.fields[*at]) != taken.type) return 1;
    }
    if (taken.type == Type::u8 && type == Type::u16) return 257;
    return taken.type == Type::u16 && type == Type::u8 ? Real{1} / 257 : 1;
  }

  std::unique_ptr<InputCloud> other_;
  Contract contract_;
  std::string vote_;
  std::optional<double> missing_;
  NearestQuery query_;
  std::vector<Taken> taken_;
};

}  // namespace

std::vector<NamedCloudFormula> change_formulas() {
  return {{"distance_to", cloud_formula_made<NearestDistance>},
          {"m3c2", cloud_formula_made<ChangeAlongNormals>},
          {"take", cloud_formula_made<TakenValues>}};
}

}  // namespace pointsweep
