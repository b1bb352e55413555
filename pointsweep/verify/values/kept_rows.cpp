// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/kept_rows.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/points/text_file.h"
#include "pointsweep/points/with_type.h"
#include "pointsweep/polygons/polygon_text.h"
#include "pointsweep/verify/formulas/regions.h"
#include "pointsweep/verify/formulas/thinning.h"
#include "pointsweep/verify/values/named_options.h"
#include "pointsweep/verify/values/stage_formula.h"
#include "pointsweep/verify/values/stored_values.h"

namespace pointsweep {
namespace {

/// A flag for each selected row of a cloud: true if it is kept.
using Mask = std::vector<bool>;

constexpr std::uint64_t kVoxelSeed = 0x766f78656c;  // "voxel" in ASCII

/// A point that competes with the other points of its group. The point with the least key() is kept.
struct Competitor {
  Vec3 group;
  double first = 0;          ///< value that decides first
  std::uint64_t second = 0;  ///< value that decides between equal `first`, before the position and the row
  Vec3 at;
  std::uint64_t row = 0;

  auto key() const { return std::tuple(group.x, group.y, group.z, first, second, at.x, at.y, at.z, row); }
};

/// A function that returns the group of a point, and the values by which the point competes in the group.
using Competes = std::function<Competitor(Vec3 p, std::uint64_t row)>;

/// Returns the number of the turn that processes a group; equal for -0 and 0.
std::uint64_t turn_of(Vec3 p, std::uint64_t turns) {
  std::uint64_t hash = 0;
  for (const double v : {p.x, p.y, p.z}) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(v + 0.0)) * 0x9E3779B97F4A7C15;
    hash ^= hash >> 29;
  }
  return hash % turns;
}

Mask least_of_groups(InputCloud& cloud, const Competes& competes, std::uint64_t memory_bytes,
                     const PhaseProgress& progress) {
  Mask kept(cloud.count(), true);
  const std::uint64_t turns = 1 + cloud.count() * 2 * sizeof(Competitor) / std::max<std::uint64_t>(memory_bytes, 1);
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    std::vector<Competitor> points;
    RowSource source(cloud);
    for_each_position(source, "reading", progress, [&](std::uint64_t row, Vec3 p) {
      if (!is_finite(p)) return;
      const Competitor next = competes(p, row);
      if (turn_of(next.group, turns) == turn) points.push_back(next);
    });
    std::ranges::sort(points, {}, &Competitor::key);
    for (std::size_t i = 1; i < points.size(); ++i)
      if (points[i].group == points[i - 1].group) kept[points[i].row] = false;
  }
  return kept;
}

formulas::Coordinates coordinates(Vec3 p) { return {p.x, p.y, p.z}; }

Competitor in_voxel(double size, bool random, Vec3 p, std::uint64_t row) {
  const auto [x, y, z] = formulas::voxel_of(coordinates(p), size);
  if (random) return {{x, y, z}, 0, formulas::hash_of(coordinates(p), kVoxelSeed), p, row};
  return {{x, y, z}, formulas::distance2_to_center(coordinates(p), size), 0, p, row};
}

/// The arguments of a formula of kept rows.
struct KeptInput {
  InputCloud& cloud;
  const NamedOptions& options;
  std::uint64_t memory_bytes;
  const PhaseProgress& progress;
};

Mask by_hash(const KeptInput& in) {
  const auto& [cloud, options, memory_bytes, progress] = in;
  const std::uint64_t seed = options.whole("seed");
  const double share = options.number("share");
  Mask kept(cloud.count(), true);
  RowSource source(cloud);
  for_each_position(source, "reading", progress, [&](std::uint64_t row, Vec3 p) {
    kept[row] = !is_finite(p) || formulas::is_in_share(formulas::hash_of(coordinates(p), seed), share);
  });
  return kept;
}

/// Keeps the points with the least hashes, or all other points. Memory: 16 bytes × option `number`.
Mask by_least_hashes(const KeptInput& in) {
  const auto& [cloud, options, memory_bytes, progress] = in;
  const std::uint64_t number = options.whole("number"), seed = options.whole("seed");
  const bool rest = options.word("rest") == "yes";
  Mask kept(cloud.count(), true);
  std::priority_queue<std::pair<std::uint64_t, std::uint64_t>> least;
  RowSource source(cloud);
  for_each_position(source, "reading", progress, [&](std::uint64_t row, Vec3 p) {
    if (!is_finite(p)) return;
    kept[row] = rest;
    least.emplace(formulas::hash_of(coordinates(p), seed) / 2048, row);
    if (least.size() > number) least.pop();
  });
  for (; !least.empty(); least.pop()) kept[least.top().second] = !rest;
  return kept;
}

std::vector<formulas::PolygonRings> polygons_of(const std::string& option) {
  const std::string text = is_polygon_text(option) ? option : read_text_file(option, "polygons as WKT or GeoJSON");
  std::vector<formulas::PolygonRings> polygons;
  for (const Polygon& polygon : polygons_of_text(text, option)) {
    formulas::PolygonRings& rings = polygons.emplace_back();
    for (const Ring& ring : polygon.rings) {
      rings.emplace_back();
      for (const Point2& corner : ring) rings.back().push_back({corner.x, corner.y});
    }
  }
  return polygons;
}

/// Keeps the points in a region, or all other points. Also decides about points with non-finite coordinates.
Mask by_region(const KeptInput& in) {
  const auto& [cloud, options, memory_bytes, progress] = in;
  std::vector<double> bounds;
  if (options.has("bounds")) bounds = options.numbers("bounds");
  std::vector<formulas::PolygonRings> polygons;
  if (options.has("polygon")) polygons = polygons_of(options.word("polygon"));
  const bool outside = options.word("outside") == "true";
  const formulas::EdgesAlongX edges(polygons);
  Mask kept(cloud.count());
  RowSource source(cloud);
  for_each_position(source, "reading", progress, [&](std::uint64_t row, Vec3 p) {
    const bool inside = formulas::is_in_box(coordinates(p), bounds) && (polygons.empty() || edges.hold({p.x, p.y}));
    kept[row] = inside != outside;
  });
  return kept;
}

/// Evaluates the formula of a condition on each row. The operator itself decides if it has no formula, and for rows
/// that the formula leaves open.
Mask by_condition(InputCloud& cloud, const SelectOperator& op, const PhaseProgress& progress) {
  const Contract contract = op.contract();
  const PositionFields position = position_fields(cloud.schema(), "the input");
  std::vector<std::uint16_t> reads;
  std::vector<std::vector<std::byte>> values;
  std::vector<Field> fields;
  for (const Attribute& a : contract.reads) {
    reads.push_back(static_cast<std::uint16_t>(reads.size()));
    values.emplace_back(a.bytes());
    fields.push_back(cloud.schema().fields[cloud.schema().find(a.fields.front()).value()]);
  }
  std::vector<const std::byte*> columns;
  for (const auto& value : values) columns.push_back(value.data());
  const std::unique_ptr<StageFormula> formula = formula_of(op);
  FormulaInput known;
  known.reads.resize(fields.size());
  Mask kept;
  RowSource source(cloud);
  for (std::uint64_t row = 0; row < source.count();) {
    stop_if_cancelled();
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(source.block_rows(), source.count() - row));
    const std::span<const std::byte> records = source.read(row, n);
    for (std::size_t i = 0; i < n; ++i, ++row) {
      const std::byte* record = records.data() + i * source.schema().stride;
      for (std::size_t f = 0; f < fields.size(); ++f)
        put_value(fields[f], record, contract.reads[f].type, values[f].data());
      const double x = value_of(position.x, record), y = value_of(position.y, record), z = value_of(position.z, record);
      if (formula != nullptr) {
        known.place.at = {x, y, z};
        for (std::size_t f = 0; f < fields.size(); ++f)
          known.reads[f].value.x = number_in(contract.reads[f].type, columns[f]);
        if (const formulas::Estimate holds = formula->evaluate(known).front(); !holds.is_open()) {
          kept.push_back(holds.value.x == 1);
          continue;
        }
      }
      const std::uint32_t no_list[2] = {0, 0};
      std::uint8_t decision = 0;
      op.keep({{&x, &y, &z, &row, columns.data()}, 1, nullptr, no_list, nullptr, reads, {}}, {&decision, 1});
      kept.push_back(decision != 0);
    }
    if (progress) progress("reading", row, source.count());
  }
  return kept;
}

Mask first_of_place(const KeptInput& in) {
  const Competes competes = [](Vec3 p, std::uint64_t row) { return Competitor{p, 0, 0, {}, row}; };
  return least_of_groups(in.cloud, competes, in.memory_bytes, in.progress);
}

Mask one_of_voxel(const KeptInput& in) {
  const double size = in.options.number("size");
  const bool random = in.options.word("keep") == "hash";
  const Competes competes = [=](Vec3 p, std::uint64_t row) { return in_voxel(size, random, p, row); };
  return least_of_groups(in.cloud, competes, in.memory_bytes, in.progress);
}

Mask by_disks(const KeptInput& in) {
  if (in.options.has("radius_from"))
    fail_usage(
        "verify: which rows 'poisson' leaves out with radius_from is not checked; verify the output of the stages "
        "before it.");
  return rows_of_disks(in.cloud, in.options.number("radius"), in.memory_bytes, in.progress);
}

using KeptFormula = Mask (*)(const KeptInput& in);
/// Returns the formula of the rows that an operator keeps; null if the operator is a condition on each row or unknown.
KeptFormula kept_formula_of(const std::string& name) {
  static const std::map<std::string_view, KeptFormula> all = {{"decimate", by_hash},   {"sample", by_least_hashes},
                                                              {"crop", by_region},     {"unique", first_of_place},
                                                              {"voxel", one_of_voxel}, {"poisson", by_disks}};
  const auto found = all.find(name);
  return found == all.end() ? nullptr : found->second;
}

Mask kept_by(const StageOperator& stage, InputCloud& cloud, std::uint64_t memory_bytes, const PhaseProgress& progress) {
  const Operator& op = *operator_of(stage);
  const NamedOptions options(op.name(), op.declared_options());
  if (const KeptFormula formula = kept_formula_of(op.name())) return formula({cloud, options, memory_bytes, progress});
  if (const auto* select = std::get_if<std::shared_ptr<const SelectOperator>>(&stage))
    return by_condition(cloud, **select, progress);
  fail_usage("verify: which rows '{}' leaves out is not checked; verify the output of the stages before it.",
             op.name());
}

/// Returns `kept`, flags of the rows that `cloud` has selected, as a selection of all its rows.
RowSelection selection_of(const InputCloud& cloud, const Mask& kept) {
  const RowSelection* const before = cloud.selection().get();
  const std::uint64_t rows = before == nullptr ? cloud.count() : before->rows();
  auto all = std::make_shared<Mask>(rows);
  std::optional<SelectionCursor> left;
  if (before != nullptr) left.emplace(*before);
  for (std::uint64_t row = 0, i = 0; row < rows; ++row)
    if (!left || left->has(row)) (*all)[row] = kept[i++];
  return {rows, [all](std::uint64_t block, std::span<std::byte> bits) {
            std::ranges::fill(bits, std::byte{0});
            const std::uint64_t first = block * RowSelection::kBlockRows;
            for (std::uint64_t i = 0; i < RowSelection::kBlockRows && first + i < all->size(); ++i)
              if ((*all)[first + i]) bits[i / 8] |= std::byte{1} << i % 8;
          }};
}

}  // namespace

bool has_kept_formula(const Operator& op) { return kept_formula_of(op.name()) != nullptr; }

InputCloud with_kept_rows(const InputCloud& cloud, const std::vector<StageOperator>& operators,
                          std::uint64_t memory_bytes, const PhaseProgress& progress) {
  InputCloud left = cloud;
  for (const StageOperator& op : operators)
    left = left.selected(selection_of(left, kept_by(op, left, memory_bytes, progress)));
  return left;
}

}  // namespace pointsweep
