// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/label_formula.h"

#include <unordered_map>

#include "pointsweep/verify/search/nearest_in_stream.h"

namespace pointsweep {

using formulas::Estimate;
using formulas::exactly;
using formulas::Real;

std::vector<Estimates> LabelsOfRows::of(std::span<const CloudPoint> points) const {
  std::vector<Estimates> made;
  for (const CloudPoint& p : points) {
    const std::int64_t number = labels.number[item_of_row[p.at.row]];
    const std::uint64_t size = number < 0 ? 0 : labels.size[static_cast<std::size_t>(number)];
    made.push_back({exactly(static_cast<Real>(number)), exactly(static_cast<Real>(size))});
  }
  return made;
}

void require_plain_neighbors(const CloudInput& in) {
  if (in.has_rule) throw NotTold("neighbourhoods differ from point to point");
}

void LabelFormula::prepare(const CloudInput& in) {
  require_plain_neighbors(in);
  try {
    found_ = labels(in);
  } catch (const NeedsMemory& why) {
    label_columns(in, columns(in));
    limits_ = std::string("that they are apart and in order ") + why.what();
  }
}

std::vector<Estimates> LabelFormula::evaluate(std::span<const CloudPoint> points, const CloudInput& in) {
  return is_found() ? found_.of(points) : labels_of_neighbors(points, in);
}

Estimate LabelFormula::alone(std::span<const double>) const { return formulas::open(); }

std::vector<ColumnSource> LabelFormula::label_columns(const CloudInput& in, std::span<const ColumnSource> more) {
  if (!in.makes[0]) throw NotTold("its numbers are not in the output");
  std::vector<ColumnSource> columns = {*in.makes[0]};
  columns.insert(columns.end(), more.begin(), more.end());
  in.rows.require(columns);
  return columns;
}

std::vector<Estimates> LabelFormula::labels_of_neighbors(std::span<const CloudPoint> points,
                                                         const CloudInput& in) const {
  const std::vector<Vec3> places = positions_of(points);
  const NeighborRule& list = in.neighborhood;
  const PointsOfCloud all = [&](const auto& take) {
    for_each_position(in.rows.input(), "searching", in.rows.progress(), take);
  };
  const auto near = nearest_of_cloud(
      places, all, in.rows.count(),
      {.most = list.k == NeighborRule::kUnlimited ? list.k : list.k + 1, .reach2 = list.radius * list.radius});

  std::unordered_map<std::uint64_t, std::vector<double>> values;  // values of the points and their neighbours, by row
  for (std::size_t i = 0; i < points.size(); ++i) {
    values[points[i].at.row];
    for (const NearPoint& n : near[i]) values[n.row];
  }
  const std::vector<ColumnSource> sources = label_columns(in, columns(in));
  in.rows.for_each(sources, [&](std::uint64_t row, Vec3, std::span<const double> read) {
    if (const auto known = values.find(row); known != values.end()) known->second.assign(read.begin(), read.end());
  });
  std::unordered_map<double, std::uint64_t> sizes;  // size of each component, by its number
  for (const auto& [row, read] : values) sizes[read[0]];
  in.rows.for_each(std::span(sources).first(1), [&](std::uint64_t, Vec3, std::span<const double> read) {
    if (const auto known = sizes.find(read[0]); known != sizes.end()) ++known->second;
  });

  std::vector<Estimates> made;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::vector<double>& own = values.at(points[i].at.row);
    const std::span here = std::span(own).subspan(1);
    Estimate number = alone(here);
    std::size_t left = list.k;
    for (const NearPoint& n : near[i]) {
      if (n.row == points[i].at.row || left == 0) continue;
      --left;
      const std::vector<double>& other = values.at(n.row);
      const Join join = joined(here, std::span(other).subspan(1), n.distance2);
      if (join == Join::no) continue;
      number = exactly(other[0]);
      if (join == Join::as_first || other[0] != own[0]) break;
    }
    const std::uint64_t size = own[0] < 0 ? 0 : sizes.at(own[0]);
    made.push_back({number, exactly(static_cast<Real>(size))});
  }
  return made;
}

}  // namespace pointsweep
