// SPDX-License-Identifier: MIT
/// The members of ChainValues for stages whose values depend on all points of the cloud, and for points with non-finite
/// coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <utility>

#include "pointsweep/verify/chain_values.h"
#include "pointsweep/verify/values/sorted_cloud.h"

namespace pointsweep {

/// Returns the operators that make the attributes read by a contract; null for attributes of the input.
std::vector<const Operator*> ChainValues::makers_of_reads(const Contract& contract) const {
  std::vector<const Operator*> makers;
  for (const Attribute& a : contract.reads) {
    const auto known = latest_.find(a.name);
    const Stage* const maker = known == latest_.end() ? nullptr : maker_of(known->second);
    makers.push_back(maker == nullptr ? nullptr : operator_of(maker->op));
  }
  return makers;
}

/// Returns the fields of the input or the output that hold the attribute of a column; nothing if there are none. If
/// several stages make an attribute, the output holds only the values of the last stage, and it holds normals as
/// orient() has turned them.
std::optional<ColumnSource> ChainValues::source_of(std::uint16_t column, const OutputColumns& in_output) const {
  const Attribute& attribute = columns_[column];
  if (maker_of(column) == nullptr) {
    for (const FileColumn& f : file_columns_)
      if (f.column == column) return ColumnSource{.attribute = attribute, .in_input = f.fields};
    return std::nullopt;
  }
  ColumnSource source{.attribute = attribute};
  if (const std::uint16_t last = latest_.at(attribute.name); last != column) {
    const Stage& turning = *maker_of(last);
    if (name_of(turning.op) != "turned_normals" || turning.reads[0] != column) return std::nullopt;
    const auto turned = in_output(contract_of(turning.op).reads[1]);
    if (!turned) return std::nullopt;
    source.turned_by = turned->front();
  }
  const auto found = in_output(attribute);
  if (!found) return std::nullopt;
  source.in_output = *found;
  return source;
}

namespace {

/// Points of a sorted cloud with their neighbours, appended one by one.
class SomePoints {
 public:
  explicit SomePoints(const SortedCloud& cloud) : cloud_(cloud) {}
  std::uint32_t first() const { return first_; }
  std::size_t size() const { return lists_.size(); }
  /// Adds the next point. `list`: squared distance and number of each neighbour of the point.
  void add(std::vector<std::pair<double, std::uint32_t>> list) {
    std::ranges::sort(list);
    lists_.push_back(std::move(list));
  }
  /// Returns the points added since the last call, with neighbours nearest first, equal distances ordered by x, y, z,
  /// then row.
  Surroundings take(std::size_t rings) {
    Surroundings out;
    const auto add_point = [&](std::uint32_t i) { return out.add(cloud_.position(i), cloud_.row_of(i)); };
    const auto count = static_cast<std::uint32_t>(lists_.size());
    for (std::uint32_t i = 0; i < count; ++i) add_point(first_ + i);
    std::unordered_map<std::uint32_t, std::uint32_t> others;
    out.list_begin.push_back(0);
    for (const auto& list : lists_) {
      for (const auto& [d2, j] : list) {
        const bool is_one = j >= first_ && j - first_ < count;
        const auto [other, is_new] = is_one ? std::pair(others.end(), false) : others.try_emplace(j);
        if (is_new) other->second = add_point(j);
        out.neighbors.push_back(is_one ? j - first_ : other->second);
      }
      out.list_begin.push_back(out.neighbors.size());
    }
    out.ring_end.assign(rings + 1, out.size());
    out.ring_end[0] = count;
    first_ += count;
    lists_.clear();
    return out;
  }

 private:
  const SortedCloud& cloud_;
  std::uint32_t first_ = 0;
  std::vector<std::vector<std::pair<double, std::uint32_t>>> lists_;
};

constexpr std::uint64_t kPointsAtOnce = 1 << 17;

}  // namespace

/// Evaluates the points in the order of SortedCloud.
std::vector<double> ChainValues::made_by_operators(const std::string& attribute, CloudRows& rows,
                                                   const NeighborRule& neighborhood) {
  const auto of_name = latest_.find(attribute);
  if (of_name == latest_.end()) throw NotTold("what it reads is not made");
  const Attribute& a = columns_[of_name->second];
  std::vector<std::string> untold =
      look_at_cloud(rows, neighborhood, nullptr, [](const Attribute&) { return std::nullopt; });
  if (!untold.empty()) throw NotTold(untold.front());
  for (Stage& stage : stages_) {
    if (stage.ring >= 0 && !contract_of(stage.op).values.empty())
      throw NotTold("what it reads depends on values of the whole cloud");
    if (!stage.cloud) stage.formula = nullptr, stage.applied = true;
  }
  const CloudInput in{.rows = rows, .reads = {}, .makes = {}, .neighborhood = neighborhood, .has_rule = false};
  // If stages read values of neighbours, all points are evaluated at once.
  const std::uint64_t count = rows.count(), at_once = rings() <= 1 ? std::min(count, kPointsAtOnce) : count;
  const std::uint64_t k = neighborhood.k == NeighborRule::kUnlimited ? 64 : neighborhood.k;
  const std::uint64_t each = 2 * bytes_per_point() + 200 + 64 * k, components = a.fields.size();
  const SortedCloud cloud(in, {}, components * sizeof(double) + at_once * each / std::max<std::uint64_t>(count, 1));
  std::size_t offset = 0;
  for (std::size_t m = 0; made_[m].name != attribute; ++m) offset += made_[m].bytes();
  Field field;
  field.type = a.type;
  std::vector<double> values(count * components, std::numeric_limits<double>::quiet_NaN());
  SomePoints points(cloud);
  const auto make_values = [&] {
    const std::uint32_t first = points.first();
    const std::size_t n = points.size();
    const ChainResults made = evaluate(points.take(rings()), rows.input(), rows);
    for (std::size_t i = 0; i < n; ++i)
      for (std::uint32_t c = 0; c < components; ++c)
        values[cloud.row_of(first + static_cast<std::uint32_t>(i)) * components + c] =
            value_of(field, made.values.data() + i * result_bytes() + offset, c);
  };
  std::vector<std::pair<double, std::uint32_t>> list;
  const auto end_list = [&] {
    points.add(std::exchange(list, {}));
    if (points.size() == at_once) make_values();
  };
  cloud.for_each_neighbor(neighborhood, [&](std::uint32_t i, std::uint32_t j, double d2) {
    while (points.first() + points.size() < i) end_list();
    list.emplace_back(d2, j);
  });
  while (points.first() + points.size() < cloud.size()) end_list();
  if (points.size() > 0) make_values();
  return values;
}

/// Computes a made attribute again for all rows, because the output lacks some rows, and returns the values as a
/// source.
std::optional<ColumnSource> ChainValues::source_again(std::uint16_t column, CloudRows& rows) const {
  std::vector<StageOperator> before;
  for (const Stage* stage = stages_.data(); stage <= maker_of(column); ++stage)
    if (!drops_rows(stage->op)) before.push_back(stage->op);
  const Attribute& a = columns_[column];
  ChainValues again(std::move(before), {a.name}, rows.input().schema(), rule_);
  return ColumnSource{
      .attribute = a,
      .made_again = std::make_shared<const std::vector<double>>(again.made_by_operators(a.name, rows, neighborhood_))};
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
    const auto source = [&](std::uint16_t column) {
      return rows.output_has_all() || maker_of(column) == nullptr ? source_of(column, in_output)
                                                                  : source_again(column, rows);
    };
    std::string why;
    try {
      for (const std::uint16_t column : stage.reads) stage.sources.push_back(source(column));
      if (rows.output_has_all())
        for (const std::uint16_t column : stage.makes) stage.targets.push_back(source_of(column, in_output));
      stage.targets.resize(stage.makes.size());
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
    p.at = {around.position(i), around.row[i]};
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

/// Copies the position, and the attributes that the stage both reads and makes. Fills all other attributes that the
/// stage makes with their value for "none".
void ChainValues::leave_unchanged(const Stage& stage, const Surroundings& points, Values& values) const {
  const Contract contract = contract_of(stage.op);
  for (std::size_t m = 0; m < stage.makes.size(); ++m) {
    const std::uint16_t column = stage.makes[m];
    const Attribute& a = columns_[column];
    const auto read = std::ranges::find(contract.reads, a.name, &Attribute::name);
    const bool moves = a.name == position_attribute().name, is_read = read != contract.reads.end();
    const int before = moves ? stage.position : is_read ? stage.reads[std::size_t(read - contract.reads.begin())] : -1;
    if (before >= 0) {
      values.estimates[column] = values.estimates[static_cast<std::size_t>(before)];
      take_estimates(column, values);
      continue;
    }
    std::vector<std::byte>& bits = values.bits[column];
    bits.assign(points.size() * a.bytes(), a.fill);
    for (std::size_t i = 0; moves && i < points.size(); ++i) {
      const Vec3 p = points.position(i);
      std::memcpy(bits.data() + i * a.bytes(), &p, sizeof p);
    }
    take_bits(column, {}, values);
  }
}

/// Evaluates a stage for points with non-finite coordinates. Returns false if the stage leaves such points unchanged.
bool ChainValues::take_unplaced(const Stage& stage, const Surroundings& points, Values& values) const {
  for (const std::uint16_t column : stage.makes) values.estimates[column].clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    CloudPoint point{{points.position(i), points.row[i]}, {}};
    for (const std::uint16_t column : stage.reads)
      point.reads.push_back(values.estimates[column][i * estimates_of(columns_[column])]);
    const auto made = stage.cloud->unplaced(point);
    if (!made) return false;
    for (std::size_t m = 0; m < stage.makes.size(); ++m) values.estimates[stage.makes[m]].push_back((*made)[m]);
  }
  for (const std::uint16_t column : stage.makes) take_estimates(column, values);
  return points.size() > 0;
}

ChainResults ChainValues::evaluate_unplaced(std::span<const KnownPoint> points, RowSource& in) const {
  Surroundings around;
  for (const KnownPoint& p : points) around.add(p.position, p.row);
  around.ring_end.assign(rings() + 1, points.size());
  around.list_begin.assign(points.size() + 1, 0);
  Values values = values_of_input(around, in);
  const std::vector<bool> certain(points.size());
  for (const Stage& stage : stages_) {
    if (stage.ring < 0 || (stage.cloud && take_unplaced(stage, around, values))) continue;
    if (!stage.cloud && is_pointwise(stage.op))
      evaluate_local(stage, around, certain, values);
    else
      leave_unchanged(stage, around, values);
  }
  return results_of(points.size(), values);
}

}  // namespace pointsweep
