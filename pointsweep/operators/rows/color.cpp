// SPDX-License-Identifier: MIT
/// Colours from the values of an attribute.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "pointsweep/colors/color_map.h"
#include "pointsweep/fail.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/declare/declarations.h"
#include "pointsweep/operators/declare/option_table.h"
#include "pointsweep/operators/expressions/named_values.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {
namespace {

const OptionTable<ColorOptions>& color_options() {
  static const OptionTable<ColorOptions> table = {
      option("by", &ColorOptions::by,
             "attribute of the input, component of one that an earlier stage computes, or x, y or z; 'by=' may be left "
             "out",
             {.kind = OptionKind::attribute, .required = true, .positional = true, .sample = "z"}),
      option("map", &ColorOptions::map, "colour map for numbers, or the colours of the classes of LAS",
             {.choices = {"viridis", "turbo", "gray", "classes"}}),
      option("range", &ColorOptions::range,
             "values at the ends of the colour map; without this option, the least and the greatest of the cloud",
             {.sample = "0,10"}),
      option("bits", &ColorOptions::bits,
             "bits of a colour channel: 8, or 16 as in LAS; auto takes 16 where the input has colours of 16 bits or "
             "fields of LAS",
             {.choices = {"auto", "8", "16"}})};
  return table;
}

/// The least and the greatest finite value of a component of an attribute.
class LeastAndMost final : public Reduction {
 public:
  LeastAndMost(Attribute of, std::size_t component, bool of_input)
      : of_(std::move(of)), component_(component), of_input_(of_input) {}
  std::string text() const override { return fmt::format("least and most of {} {}", of_.name, component_); }
  std::vector<Attribute> reads() const override { return {of_}; }
  bool of_input() const override { return of_input_; }
  std::unique_ptr<Accumulator> start() const override { return std::make_unique<Ends>(component_, of_.fields.size()); }

 private:
  class Ends final : public Accumulator {
   public:
    Ends(std::size_t component, std::size_t width) : component_(component), width_(width) {}
    void add(const double* values, std::size_t points) override {
      for (std::size_t i = 0; i < points; ++i) include(values[i * width_ + component_]);
    }
    void merge(const Accumulator& other) override {
      const auto& ends = static_cast<const Ends&>(other);
      if (ends.lo_ <= ends.hi_) include(ends.lo_), include(ends.hi_);
    }
    std::vector<std::byte> save() const override {
      Encoder out;
      out.begin(kEncoding);
      out.put<double>(lo_);
      out.put<double>(hi_);
      return out.take();
    }
    void load(std::span<const std::byte> bytes) override {
      Decoder in(bytes);
      in.begin(kEncoding);
      const auto lo = in.get<double>(), hi = in.get<double>();
      in.finish();
      include(lo), include(hi);
    }
    std::vector<double> finish() const override { return {lo_, hi_}; }

   private:
    static constexpr Encoding kEncoding{"ends of values", 1};
    void include(double v) {
      if (std::isfinite(v)) lo_ = std::min(lo_, v + 0.0), hi_ = std::max(hi_, v + 0.0);
    }
    std::size_t component_, width_;
    double lo_ = std::numeric_limits<double>::infinity(), hi_ = -std::numeric_limits<double>::infinity();
  };

  Attribute of_;
  std::size_t component_;
  bool of_input_;
};

Attribute color_attribute(Type type) {
  return {"color", type, Kind::color, {"red", "green", "blue"}, "1", "colour of an attribute's value"};
}

/// Makes "color": red, green and blue.
class Color final : public LocalOperator {
 public:
  /// Messages begin with `place`. Throws UsageError for a range that is not two numbers, the first not above the
  /// second, and for a range with ColorMap::classes.
  explicit Color(ColorOptions options, std::string place = "color");
  std::string name() const override { return "color"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override {
    const NamedValues::Batch batch(names_, in);
    type_ == Type::u16 ? fill<std::uint16_t>(batch.values(), out) : fill<std::uint8_t>(batch.values(), out);
  }
  std::shared_ptr<const LocalOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const override;

 private:
  /// Returns the source of the values that are coloured. Must be called after bound().
  NamedValues::Source source() const { return names_.sources().front(); }
  template <class T>
  void fill(std::span<const ExpressionValues> values, Columns& out) const;

  ColorOptions options_;
  std::string place_;
  std::optional<Expression> by_;  ///< the name of the attribute; absent before bound()
  NamedValues names_;
  bool of_input_ = false;  ///< true if the values come from the input, not from an earlier stage
  Type type_ = Type::u8;
};

}  // namespace

OperatorDeclaration color_declaration() {
  return {.name = "color",
          .meaning = "colours points by the values of an attribute",
          .options = color_options().declarations(),
          .make = color_options().maker<Color>(),
          .formula =
              "t = (v - lo) / (hi - lo), at least 0, at most 1; 0 if lo = hi. Channels of 8 bits, halves upwards:\n"
              "viridis: linear between ten colours; turbo: a polynomial of degree 5; gray: 255 t.\n"
              "classes: the colour of class v, rounded, as render draws it. Of 16 bits: 257 times that.",
          .source = "Viridis: van der Walt and Smith 2015. Turbo: Mikhailov 2019.",
          .undefined = "NaN is grey (128).",
          .cost =
              "without a range one more pass over the rows, which is the writing of the output where no later stage "
              "needs neighbours",
          .attributes = {{.name = "color", .meaning = "colour of the value of an attribute", .type = "u8 or u16"}},
          .example = "knn(k=12) | normals | curvature | color(k1, map=turbo, range=[0,5])"};
}

ChainStage operators::color(const ColorOptions& options) { return std::make_shared<Color>(options); }

Color::Color(ColorOptions options, std::string place) : options_(std::move(options)), place_(std::move(place)) {
  if (const std::string_view name = name_in(options_.by); !name.empty()) options_.by = std::string(name);
  color_options().declare(*this, options_);
  const std::vector<double>& range = options_.range;
  if (range.empty()) return;
  if (range.size() != 2) fail_usage("{}: range is two numbers, [LO,HI], not {}.", place_, range.size());
  if (range[0] > range[1])
    fail_usage("{}: the range begins at {} and ends at {}; give the smaller number first.", place_, range[0], range[1]);
  if (options_.map == ColorMap::classes) fail_usage("{}: classes have no range; leave it out.", place_);
}

Contract Color::contract() const {
  Contract contract{.reads = names_.reads(), .makes = {color_attribute(type_)}, .default_k = 0};
  if (options_.map == ColorMap::classes || !options_.range.empty() || names_.sources().empty()) return contract;
  const auto [attribute, component] = source();
  const Attribute of = attribute < 0 ? position_attribute() : names_.reads()[static_cast<std::size_t>(attribute)];
  contract.values = {std::make_shared<LeastAndMost>(of, component, of_input_)};
  return contract;
}

std::shared_ptr<const LocalOperator> Color::bound(const Schema& input, std::span<const Attribute> made) const {
  auto bound = std::make_shared<Color>(*this);
  const Expression by = expression_of_attribute(options_.by, place_, input, made);
  if (!by.is_name())
    fail_usage("{}: '{}' is not the name of an attribute; make one before by set(NAME = ...).", place_, options_.by);
  bound->by_ = by;
  bound->names_ = NamedValues(by, place_, input, made);
  const int attribute = bound->source().attribute;
  const std::string read =
      attribute < 0 ? position_attribute().name : bound->names_.reads()[static_cast<std::size_t>(attribute)].name;
  bound->of_input_ = !makes(made, read);
  const auto red = input.find("red");
  const bool wide = input.find("point_source_id") || (red && input.fields[*red].type == Type::u16);
  bound->type_ =
      options_.bits == ColorBits::sixteen || (options_.bits == ColorBits::automatic && wide) ? Type::u16 : Type::u8;
  return bound;
}

std::shared_ptr<const LocalOperator> Color::with_values(std::span<const std::vector<double>> values) const {
  ColorOptions options = options_;
  const bool any = values[0][0] <= values[0][1];  // false for a cloud without finite values
  options.range = any ? values[0] : std::vector<double>{0, 0};
  auto known = std::make_shared<Color>(std::move(options), place_);
  known->by_ = by_, known->names_ = names_, known->of_input_ = of_input_, known->type_ = type_;
  return known;
}

template <class T>
void Color::fill(std::span<const ExpressionValues> values, Columns& out) const {
  const auto to = out.column<std::array<T, 3>>(0);
  std::vector<double> numbers(out.size());
  by_.value().evaluate_number(values, numbers);
  constexpr unsigned kWiden = sizeof(T) == 1 ? 1 : 257;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const double v = numbers[i];
    Rgb color;
    if (options_.map == ColorMap::classes) {
      color = std::isnan(v) ? no_value_color()
                            : color_of_las_class(static_cast<std::uint8_t>(std::clamp(v, 0.0, 255.0) + 0.5));
    } else {
      const double lo = options_.range[0], hi = options_.range[1];
      const double t = hi > lo ? (v - lo) / (hi - lo) : 0 * v;
      color = options_.map == ColorMap::turbo ? turbo(t) : options_.map == ColorMap::gray ? gray(t) : viridis(t);
    }
    to[i] = {static_cast<T>(color.red * kWiden), static_cast<T>(color.green * kWiden),
             static_cast<T>(color.blue * kWiden)};
  }
}

}  // namespace pointsweep
