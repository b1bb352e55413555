// SPDX-License-Identifier: MIT
/// The part of ChainValues that depends on all points.
#include <fmt/format.h>

#include <algorithm>
#include <typeinfo>

#include "pointsweep/operators/orient.h"
#include "pointsweep/verify/chain_values.h"

namespace pointsweep {

/// The operators that make what a contract reads; null: the input.
std::vector<const Operator*> ChainValues::makers_of_reads(const Contract& contract) const {
  std::vector<const Operator*> makers;
  for (const Attribute& a : contract.reads) {
    makers.push_back(nullptr);
    for (const auto& [name, column] : latest_)
      if (name == a.name && maker_[column] >= 0)
        makers.back() = stages_[static_cast<std::size_t>(maker_[column])].op.get();
  }
  return makers;
}

/// The output has the last version of an attribute, and normals before orient() has turned some of them.
std::optional<ColumnSource> ChainValues::source_of(std::uint16_t column, const OutputColumns& in_output) const {
  const Attribute& attribute = columns_[column];
  if (maker_[column] < 0) {
    for (const FileColumn& f : file_columns_)
      if (f.column == column) return ColumnSource{.attribute = attribute, .in_input = f.fields};
    return std::nullopt;
  }
  const auto last =
      std::find_if(latest_.begin(), latest_.end(), [&](const auto& l) { return l.first == attribute.name; });
  ColumnSource source{.attribute = attribute};
  if (last->second != column) {
    const Stage& turning = stages_[static_cast<std::size_t>(maker_[last->second])];
    if (typeid(*turning.op) != typeid(TurnedNormals) || turning.reads[0] != column) return std::nullopt;
    const auto turned = in_output(normal_turned_attribute());
    if (!turned) return std::nullopt;
    source.turned_by = turned->front();
  }
  const auto found = in_output(attribute);
  if (!found) return std::nullopt;
  source.in_output = *found;
  return source;
}

CloudInput ChainValues::cloud_input(const Stage& stage, CloudRows& rows) const {
  return {.rows = rows,
          .reads = stage.sources,
          .makes = stage.targets,
          .neighborhood = neighborhood_,
          .has_rule = static_cast<bool>(rule_),
          .before_means = before_means_};
}

std::vector<std::string> ChainValues::look_at_cloud(CloudRows& rows, const NeighborRule& neighborhood,
                                                    InputCloud* before_means, const OutputColumns& in_output) {
  neighborhood_ = neighborhood, before_means_ = before_means;
  std::vector<std::string> untold;
  for (Stage& stage : stages_) {
    if (!stage.cloud || stage.ring < 0) continue;
    for (const std::uint16_t column : stage.reads) stage.sources.push_back(source_of(column, in_output));
    for (const std::uint16_t column : stage.makes) stage.targets.push_back(source_of(column, in_output));
    std::string why;
    try {
      stage.cloud->prepare(cloud_input(stage, rows));
      why = stage.cloud->limits();
    } catch (const NotTold& reason) {
      stage.told = false;
      why = reason.what();
    }
    if (why.empty()) continue;
    std::string names;
    for (const std::uint16_t column : stage.makes) names += (names.empty() ? "" : " ") + columns_[column].name;
    untold.push_back(fmt::format("{}: {}", names, why));
  }
  return untold;
}

void ChainValues::evaluate_cloud(const Stage& stage, const Surroundings& around, CloudRows& rows,
                                 ColumnEstimates& columns) const {
  const std::size_t count = around.ring_end[static_cast<std::size_t>(stage.ring)];
  std::vector<CloudPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    CloudPoint& p = points.emplace_back();
    p.at = {{around.x[i], around.y[i], around.z[i]}, around.row[i]};
    for (const std::uint16_t column : stage.reads) p.reads.push_back(columns[column][i]);
  }
  std::vector<std::vector<formulas::Estimate>> made(count);
  if (stage.told) made = stage.cloud->evaluate(points, cloud_input(stage, rows));
  for (const std::uint16_t column : stage.makes) columns[column].clear();
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t next = 0;
    for (const std::uint16_t column : stage.makes)
      for (std::size_t e = 0; e < estimates_of(columns_[column]); ++e)
        columns[column].push_back(stage.told ? made[i][next++] : formulas::open());
  }
}

}  // namespace pointsweep
