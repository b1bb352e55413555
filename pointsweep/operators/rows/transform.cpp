// SPDX-License-Identifier: MIT
/// Moving all points by a matrix, and converting their directions and lengths.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/operators/rows/affine_map.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/row_error.h"

namespace pointsweep {
namespace {

/// Largest relative differences that count as rounding: files may state matrices with only six digits.
constexpr double kSameScale = 1e-6, kSameShape = 1e-5;

const OptionTable<TransformOptions>& transform_options() {
  static const OptionTable<TransformOptions> table = {
      option(
          "matrix", &TransformOptions::matrix,
          "file with a matrix of 4 rows of 4 numbers, the last one 0 0 0 1, or these numbers row by row; the last row "
          "may be left out",
          {.kind = OptionKind::matrix, .positional = true, .sample = "0.8,-0.6,0,5,0.6,0.8,0,-3,0,0,1,0.5"}),
      option("scale", &TransformOptions::scale, "factor of the coordinates, after the matrix", {.least = kAboveZero}),
      option("translate", &TransformOptions::translate, "added to the coordinates, after the scale",
             {.unit = "length", .sample = Vec3{1, 2, 3}}),
      option("inverse", &TransformOptions::inverse, "move the points back: the inverse of all this",
             {.choices = {"no", "yes"}})};
  return table;
}

bool is_direction(const Attribute& a) {
  return (a.kind == Kind::normal || a.kind == Kind::vector) && a.fields.size() == 3;
}

/// Returns the attributes that the operators listed here make. Fields of the input with their names are converted, too:
/// files may contain earlier results.
const std::vector<Attribute>& known_attributes() {
  static const std::vector<Attribute> all = [] {
    using namespace operators;
    std::vector<Attribute> known;
    for (const ChainStage& stage : {normals(), curvature(), splats(), features(), sor(), lof(), density(), height(),
                                    segments(), neighborhood_size(), simplify({.error = 1}),
                                    distance_to({.cloud = "-"}), m3c2({.cloud = "-", .cylinder = 1, .depth = 1})})
      for (const Attribute& a : contract_of(stage).makes)
        if (!makes(known, a.name)) known.push_back(a);
    return known;
  }();
  return all;
}

/// Returns the power of the length in a unit: 2 for "length^2", -1 for "1/length", 0 for "1".
int power_of_length(const std::string& unit) {
  const std::size_t at = unit.find("length");
  if (at == unit.npos) return 0;
  const std::string power = unit.substr(at + 6);
  const int most = power == "^2" ? 2 : power == "^3" ? 3 : 1;
  return unit.starts_with("1/") ? -most : most;
}

/// Returns the scale of a map that keeps angles; 1 if the scale is within kSameScale of 1. Returns nullopt if the map
/// shears, or stretches directions differently.
std::optional<double> scale_of(const AffineMap& map) {
  const Vec3 columns[] = {map.turned({1, 0, 0}), map.turned({0, 1, 0}), map.turned({0, 0, 1})};
  const double squared = (dot(columns[0], columns[0]) + dot(columns[1], columns[1]) + dot(columns[2], columns[2])) / 3;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b)
      if (!(std::abs(dot(columns[a], columns[b]) - (a == b ? squared : 0)) <= kSameShape * squared))
        return std::nullopt;
  const double scale = std::sqrt(squared);
  return std::abs(scale - 1) <= kSameScale ? 1 : scale;
}

bool keeps_directions(const AffineMap& map) {
  return map.turned({1, 0, 0}) == Vec3{1, 0, 0} && map.turned({0, 1, 0}) == Vec3{0, 1, 0} &&
         map.turned({0, 0, 1}) == Vec3{0, 0, 1};
}

/// Moves the points, and converts each floating-point attribute that is a direction, or whose unit has a power of the
/// length: attributes of earlier stages, and attributes of the input with the names of known_attributes().
class Transform final : public LocalOperator {
 public:
  /// Reads the file with the matrix, if there is one. Throws Error, beginning with the file's name, if the file cannot
  /// be read or holds no matrix. Throws UsageError, beginning with `place`, if no option gives a motion, a matrix given
  /// as text is invalid, or the matrix is singular.
  explicit Transform(TransformOptions options, std::string place = "transform");
  std::string name() const override { return "transform"; }
  Contract contract() const override {
    Contract contract{.reads = changed_, .makes = {position_attribute()}, .default_k = 0};
    contract.makes.insert(contract.makes.end(), changed_.begin(), changed_.end());
    return contract;
  }
  /// Throws RowError naming the lowest row of the batch whose coordinates would no longer be finite.
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::array<bool, 3> changes_system() const override {
    const AffineMap none;
    return {map_.rows[0] != none.rows[0], map_.rows[1] != none.rows[1], map_.rows[2] != none.rows[2]};
  }
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  /// Returns the factor for the values of an attribute: the scale to the power of the length in the attribute's unit.
  double factor_of(const Attribute& attribute) const {
    const int power = power_of_length(attribute.unit);
    double factor = 1;
    for (int p = 0; p < std::abs(power); ++p) factor *= scale_.value_or(1);
    return power < 0 ? 1 / factor : factor;
  }
  bool changes(const Attribute& attribute) const;
  template <class T>
  void change(std::size_t number, const Neighborhoods& in, Columns& out) const;

  std::string place_;
  AffineMap map_, back_;
  std::optional<double> scale_;     ///< scale of lengths; nullopt if it depends on the direction
  std::vector<Attribute> changed_;  ///< attributes that are read and made again; set by bound()
};

}  // namespace

OperatorDeclaration transform_declaration() {
  return {
      .name = "transform",
      .meaning = "moves the points by a matrix, and turns their normals and other directions",
      .options = transform_options().declarations(),
      .make = transform_options().maker<Transform>(),
      .formula =
          "p' = A p + t: x' = ((a11 x + a12 y) + a13 z) + t1, likewise y' and z', in float64. A and t are those of the "
          "matrix, times scale, plus translate; with inverse=yes A⁻¹ and -A⁻¹ t.\n"
          "Normals: n' = |n| A⁻ᵀ n / |A⁻ᵀ n|; tangents (k1_direction, splat_axis): v' = |v| A v / |A v|.\n"
          "Lengths of an attribute with the unit lengthᵏ: times sᵏ, s² = trace(AᵀA) / 3. A scale within 1e-6 of 1 is "
          "1. A matrix that does not keep angles within 1e-5 is refused where there are lengths.\n"
          "These are the attributes of earlier stages by their declarations, and fields of the input that bear the "
          "names of attributes that operators make (nx, splat_length, mean_distance). All others keep their values; so "
          "does the coordinate reference system.",
      .undefined =
          "A point without a finite place keeps its coordinates; its directions turn. Coordinates that would no longer "
          "be finite end the run with an error that names the row.",
      .cost = "a pass over the rows, without a search; none where other stages search anyway",
      .example = "knn(k=12) | normals | transform([0,-1,0,100,1,0,0,200,0,0,1,0])"};
}

std::string unit_of_made(const std::string& name) {
  for (const Attribute& a : known_attributes())
    if (a.fields.size() == 1 && is_spelling_of(a.fields.front(), name)) return a.unit;
  return "1";
}

ChainStage operators::transform(const TransformOptions& options) { return std::make_shared<Transform>(options); }

Transform::Transform(TransformOptions options, std::string place) : place_(std::move(place)) {
  if (options.matrix.empty() && options.scale == 1 && !options.translate)
    fail_usage("{}: nothing says where the points go; give matrix=FILE, translate=[X,Y,Z] or scale=S.", place_);
  std::vector<double> numbers;
  if (!options.matrix.empty()) {
    map_ = affine_map_of(options.matrix, place_);
    for (const AffineMap::Row& row : map_.rows) numbers.insert(numbers.end(), row.begin(), row.end());
    options.matrix = text_of_numbers(numbers);
  }
  transform_options().declare(*this, options);
  const Vec3 translation = options.translate.value_or(Vec3{});
  for (std::size_t row = 0; row < 3; ++row) {
    for (double& number : map_.rows[row]) number *= options.scale;
    map_.rows[row][3] += translation[static_cast<int>(row)];
  }
  back_ = map_.inverse(place_);
  if (options.inverse) std::swap(map_, back_);
  scale_ = scale_of(map_);
}

bool Transform::changes(const Attribute& attribute) const {
  if (attribute.kind == Kind::position || (attribute.type != Type::f32 && attribute.type != Type::f64)) return false;
  if (power_of_length(attribute.unit) != 0 && !scale_)
    fail_usage(
        "{}: the matrix shears, or stretches some directions more than others, so that '{}', a length, has no value "
        "after it; drop it before, or make it after {}.",
        place_, attribute.name, name());
  return factor_of(attribute) != 1 || (is_direction(attribute) && !keeps_directions(map_));
}

std::shared_ptr<const LocalOperator> Transform::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<Transform>(*this);
  bound->changed_.clear();
  const auto take = [&](const Attribute& a) {
    if (changes(a)) bound->changed_.push_back(a);
  };
  for (const Attribute& a : made) take(a);
  for (const Attribute& a : known_attributes()) {
    if (makes(made, a.name)) continue;
    for (const Attribute& own : made)
      if (a.fields.size() > 1 && own.fields.size() == 1 && changes(a) &&
          std::ranges::any_of(a.fields, [&](const std::string& f) { return is_spelling_of(f, own.name); }))
        fail_usage("{0}: '{1}' was assigned on its own, so '{2}' cannot turn as a whole; put the assignment after {3}.",
                   place_, own.name, a.name, name());
    if (std::ranges::all_of(a.fields, [&](const std::string& f) { return field_meant(input, f).has_value(); })) take(a);
  }
  return bound;
}

template <class T>
void Transform::change(std::size_t number, const Neighborhoods& in, Columns& out) const {
  const Attribute& a = changed_[number];
  const std::size_t width = a.fields.size();
  const std::byte* const from = in.values<std::byte>(number);
  std::byte* const to = out.column<std::byte>(1 + number).data();
  const double factor = factor_of(a);
  const auto value = [&](std::size_t v) {
    T stored;
    std::memcpy(&stored, from + v * sizeof(T), sizeof(T));
    return static_cast<double>(stored);
  };
  const auto put = [&](std::size_t v, double changed) {
    const auto stored = static_cast<T>(changed);
    std::memcpy(to + v * sizeof(T), &stored, sizeof(T));
  };
  for (std::size_t i = 0; i < in.size(); ++i) {
    if (!is_direction(a)) {
      for (std::size_t v = i * width; v < (i + 1) * width; ++v) put(v, factor * value(v));
      continue;
    }
    const Vec3 before{value(3 * i), value(3 * i + 1), value(3 * i + 2)};
    const Vec3 turned = a.kind == Kind::normal ? back_.turned_by_transpose(before) : map_.turned(before);
    const double size = length(turned);
    const Vec3 after = size > 0 ? factor * length(before) / size * turned : before;
    for (std::size_t c = 0; c < 3; ++c) put(3 * i + c, after[static_cast<int>(c)]);
  }
}

void Transform::apply(const Neighborhoods& in, Columns& out) const {
  const auto positions = out.column<std::array<double, 3>>(0);
  FirstRowError refused;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Vec3 p = in.position(i), q = is_finite(p) ? map_.moved(p) : p;
    positions[i] = {q.x, q.y, q.z};
    if (is_finite(p) && !is_finite(q))
      refused.note(in.row(i), [&] {
        return RowSentence{fmt::format("{}: row ", place_),
                           fmt::format(": ({}, {}, {}) would move to ({}, {}, {}), which is not finite; check the "
                                       "matrix, or leave out such points.",
                                       p.x, p.y, p.z, q.x, q.y, q.z)};
      });
  }
  refused.throw_if_any();
  for (std::size_t number = 0; number < changed_.size(); ++number)
    if (out.wanted(1 + number))
      changed_[number].type == Type::f32 ? change<float>(number, in, out) : change<double>(number, in, out);
}

}  // namespace pointsweep
