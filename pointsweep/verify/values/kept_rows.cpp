// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/kept_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <queue>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/thinning/undecided_points.h"
#include "pointsweep/points/text_file.h"
#include "pointsweep/points/with_type.h"
#include "pointsweep/polygons/polygon_text.h"
#include "pointsweep/verify/formulas/regions.h"
#include "pointsweep/verify/formulas/thinning.h"
#include "pointsweep/verify/values/stage_formula.h"
#include "pointsweep/verify/values/stored_values.h"

namespace pointsweep {
namespace {

/// A flag for each selected row of a cloud: true if it is kept.
using Mask = std::vector<bool>;

constexpr std::uint64_t kVoxelSeed = 0x766f78656c;  // "voxel" in ASCII

formulas::Coordinates coordinates(Vec3 p) { return {p.x, p.y, p.z}; }

/// The arguments of a formula of kept rows.
struct KeptInput {
  InputCloud& cloud;
  const NamedOptions& options;
  std::uint64_t memory_bytes;
  const PhaseProgress& progress;
};

/// Returns a flag for each row: `is_kept(row, position)`.
template <class IsKept>
Mask mask_of(const KeptInput& in, IsKept is_kept) {
  Mask kept(in.cloud.count());
  RowSource source(in.cloud);
  for_each_position(source, "reading", in.progress, [&](std::uint64_t row, Vec3 p) { kept[row] = is_kept(row, p); });
  return kept;
}

/// Calls `use(items)` with the items of all finite points, in turns, so that the items of a turn fit in memory. The
/// items of a turn are sorted by Item::key(). `item_of(row, position)` makes an item; `turn_of(item, turns)` returns
/// its turn, below `turns`.
template <class Item, class ItemOf, class TurnOf, class Use>
void in_turns(const KeptInput& in, ItemOf item_of, TurnOf turn_of, Use use) {
  const std::uint64_t turns = 1 + in.cloud.count() * 2 * sizeof(Item) / std::max<std::uint64_t>(in.memory_bytes, 1);
  for (std::uint64_t turn = 0; turn < turns; ++turn) {
    std::vector<Item> items;
    RowSource source(in.cloud);
    for_each_position(source, "reading", in.progress, [&](std::uint64_t row, Vec3 p) {
      if (!is_finite(p)) return;
      const Item item = item_of(row, p);
      if (turn_of(item, turns) == turn) items.push_back(item);
    });
    std::ranges::sort(items, {}, &Item::key);
    use(items);
  }
}

/// A point that competes with the other points of its group. The point with the least key() is kept.
struct Competitor {
  formulas::Coordinates group;
  double first = 0;          ///< value that decides first
  std::uint64_t second = 0;  ///< value that decides between equal `first`, before the position and the row
  Vec3 at;
  std::uint64_t row = 0;

  auto key() const { return std::tuple(group, first, second, at.x, at.y, at.z, row); }
};

/// Keeps one point of each group, and all points that are not finite. `competitor_of(row, position)` makes the
/// competitor of a point.
template <class CompetitorOf>
Mask least_of_groups(const KeptInput& in, CompetitorOf competitor_of) {
  Mask kept(in.cloud.count(), true);
  const auto turn_of = [](const Competitor& c, std::uint64_t turns) { return formulas::hash_of(c.group, 0) % turns; };
  in_turns<Competitor>(in, competitor_of, turn_of, [&](const std::vector<Competitor>& points) {
    for (std::size_t i = 1; i < points.size(); ++i)
      if (points[i].group == points[i - 1].group) kept[points[i].row] = false;
  });
  return kept;
}

Mask by_hash(const KeptInput& in) {
  const std::uint64_t seed = in.options.whole("seed");
  const double share = in.options.number("share");
  return mask_of(in, [=](std::uint64_t, Vec3 p) {
    return !is_finite(p) || formulas::is_in_share(formulas::hash_of(coordinates(p), seed), share);
  });
}

/// Keeps the points with the least hashes, or all other finite points; points that are not finite stay. Memory: 16
/// bytes × option `number`.
Mask by_least_hashes(const KeptInput& in) {
  const std::uint64_t number = in.options.whole("number"), seed = in.options.whole("seed");
  const bool rest = in.options.word("rest") == "yes";
  std::priority_queue<std::pair<std::uint64_t, std::uint64_t>> least;
  Mask kept = mask_of(in, [&](std::uint64_t row, Vec3 p) {
    if (!is_finite(p)) return true;
    least.emplace(formulas::hash_of(coordinates(p), seed) / 2048, row);
    if (least.size() > number) least.pop();
    return rest;
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
  std::vector<double> bounds;
  if (in.options.has("bounds")) bounds = in.options.numbers("bounds");
  std::vector<formulas::PolygonRings> polygons;
  if (in.options.has("polygon")) polygons = polygons_of(in.options.word("polygon"));
  const bool outside = in.options.word("outside") == "true";
  const formulas::EdgesAlongX edges(polygons);
  return mask_of(in, [&](std::uint64_t, Vec3 p) {
    const bool inside = formulas::is_in_box(coordinates(p), bounds) && (polygons.empty() || edges.hold({p.x, p.y}));
    return inside != outside;
  });
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
  const StageFormula formula = formula_of(op);
  FormulaInput known;
  known.reads.resize(fields.size());
  Mask kept;
  RowSource source(cloud);
  for_each_row(source, "reading", progress, [&](std::uint64_t row, const std::byte* record) {
    for (std::size_t f = 0; f < fields.size(); ++f)
      put_value(fields[f], record, contract.reads[f].type, values[f].data());
    const Vec3 p = position_in(position, record);
    if (formula) {
      known.place.at = {p.x, p.y, p.z};
      for (std::size_t f = 0; f < fields.size(); ++f)
        known.reads[f].value.x = number_in(contract.reads[f].type, columns[f]);
      const formulas::Estimate holds = formula(known).front();
      if (!holds.is_open()) return kept.push_back(holds.value.x == 1);
    }
    const std::uint32_t no_list[2] = {0, 0};
    std::uint8_t decision = 0;
    op.keep({{&p.x, &p.y, &p.z, &row, columns.data()}, 1, nullptr, no_list, nullptr, reads, {}}, {&decision, 1});
    kept.push_back(decision != 0);
  });
  return kept;
}

Mask first_of_place(const KeptInput& in) {
  return least_of_groups(in, [](std::uint64_t row, Vec3 p) { return Competitor{coordinates(p), 0, 0, {}, row}; });
}

Mask one_of_voxel(const KeptInput& in) {
  const double size = in.options.number("size");
  const bool random = in.options.word("keep") == "hash";
  return least_of_groups(in, [=](std::uint64_t row, Vec3 p) {
    Competitor made{formulas::voxel_of(coordinates(p), size), 0, 0, p, row};
    if (random)
      made.second = formulas::hash_of(coordinates(p), kVoxelSeed);
    else
      made.first = formulas::distance2_to_center(coordinates(p), size);
    return made;
  });
}

/// Kept points in an index by cubes a little wider than the radius.
class KeptPoints {
 public:
  explicit KeptPoints(double radius) : radius2_(radius * radius), width_(1.0001 * radius) {}

  /// Keeps p unless a kept point lies within the radius. Returns whether p is kept.
  bool offer(Vec3 p) {
    const auto from = cube_of({p.x - width_, p.y - width_, p.z - width_});
    const auto to = cube_of({p.x + width_, p.y + width_, p.z + width_});
    // The map orders cubes by x, y, z, so the cubes with equal x and y are one range.
    for (double x = from[0]; x <= to[0]; x = above(x))
      for (double y = from[1]; y <= to[1]; y = above(y))
        for (auto cube = cubes_.lower_bound({x, y, from[2]}); cube != cubes_.end(); ++cube) {
          if (cube->first > Cube{x, y, to[2]}) break;
          for (const Vec3& kept : cube->second)
            if (distance2(kept, p) <= radius2_) return false;
        }
    cubes_[cube_of(p)].push_back(p);
    return true;
  }

 private:
  using Cube = std::array<double, 3>;
  Cube cube_of(Vec3 p) const { return {std::floor(p.x / width_), std::floor(p.y / width_), std::floor(p.z / width_)}; }
  /// Returns the next index of a cube along an axis. From 2^52 on, where not every index is a double, returns the next
  /// double.
  static double above(double number) {
    return std::abs(number) < 0x1p52 ? number + 1 : std::nextafter(number, HUGE_VAL);
  }

  double radius2_, width_;
  std::map<Cube, std::vector<Vec3>> cubes_;
};

struct HashedPoint {
  std::uint64_t hash;
  Vec3 at;
  std::uint64_t row;

  auto key() const { return std::tuple(hash, at.x, at.y, at.z, row); }
};

/// Offers the points one by one in the order of their hashes, the definition of poisson. Each turn of in_turns() takes
/// a range of hashes.
Mask by_disks(const KeptInput& in) {
  if (in.options.has("radius_from"))
    fail_usage(
        "verify: which rows 'poisson' leaves out with radius_from is not checked; verify the output of the stages "
        "before it.");
  Mask kept(in.cloud.count(), true);
  KeptPoints points(in.options.number("radius"));
  const auto point_of = [](std::uint64_t row, Vec3 p) {
    return HashedPoint{formulas::hash_of(coordinates(p), kPoissonSeed), p, row};
  };
  const auto turn_of = [](const HashedPoint& p, std::uint64_t turns) {
    return turns == 1 ? 0 : p.hash / (~std::uint64_t{0} / turns + 1);
  };
  in_turns<HashedPoint>(in, point_of, turn_of, [&](const std::vector<HashedPoint>& sorted) {
    for (const HashedPoint& p : sorted) kept[p.row] = points.offer(p.at);
  });
  return kept;
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

/// Returns flags for all rows of `cloud`. `kept`: flags for the rows that the cloud has selected.
Mask of_all_rows(const Mask& kept, const InputCloud& cloud) {
  const RowSelection* const before = cloud.selection().get();
  const std::uint64_t rows = before == nullptr ? cloud.count() : before->rows();
  Mask all(rows);
  std::optional<SelectionCursor> left;
  if (before != nullptr) left.emplace(*before);
  for (std::uint64_t row = 0, i = 0; row < rows; ++row)
    if (!left || left->has(row)) all[row] = kept[i++];
  return all;
}

}  // namespace

bool has_kept_formula(const Operator& op) { return kept_formula_of(op.name()) != nullptr; }

RowSelection selection_of(std::vector<bool> kept) {
  const auto all = std::make_shared<const Mask>(std::move(kept));
  return {all->size(), [all](std::uint64_t block, std::span<std::byte> bits) {
            std::ranges::fill(bits, std::byte{0});
            const std::uint64_t first = block * RowSelection::kBlockRows;
            const std::uint64_t n = std::min(RowSelection::kBlockRows, all->size() - first);
            for (std::uint64_t i = 0; i < n; ++i)
              if ((*all)[first + i]) bits[i / 8] |= std::byte{1} << i % 8;
          }};
}

InputCloud with_kept_rows(const InputCloud& cloud, const std::vector<StageOperator>& operators,
                          std::uint64_t memory_bytes, const PhaseProgress& progress) {
  InputCloud left = cloud;
  for (const StageOperator& op : operators)
    left = left.selected(selection_of(of_all_rows(kept_by(op, left, memory_bytes, progress), left)));
  return left;
}

}  // namespace pointsweep
