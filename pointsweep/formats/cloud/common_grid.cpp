// SPDX-License-Identifier: MIT
/// One grid for the integer coordinates of inputs whose scales and offsets differ.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "pointsweep/fail.h"
#include "pointsweep/formats/cloud/common_schema.h"

namespace pointsweep {
namespace {

/// The largest number of steps between two offsets, 2^40. It exceeds the range of 32-bit integers, since the steps have
/// the finest scale, and inputs with coarser scales may lie further apart. A larger quotient is too imprecise to tell
/// whether it is a whole number.
constexpr double kMostSteps = 1099511627776.0;

bool is_grid(const Field& field) {
  return field.type == Type::i32 && field.count == 1 && field.bit_width == 0 && field.scale > 0;
}

/// One axis of one input: its coordinate field and its bounds.
struct AxisOfInput {
  Field field;
  double lo, hi;  ///< bounds of the real coordinates in the header; lo > hi if there are none
};

/// Returns the number of steps of `scale` in one step of `coarse`; nothing unless the number is whole and in 1..2^30.
std::optional<std::int64_t> factor_between(double coarse, double scale) {
  const double ratio = coarse / scale, factor = std::nearbyint(ratio);
  const bool whole = std::abs(ratio - factor) <= 4 * std::numeric_limits<double>::epsilon() * ratio;
  if (!whole || !(factor >= 1 && factor <= 1073741824.0)) return std::nullopt;
  return static_cast<std::int64_t>(factor);
}

/// Returns the number of steps from `offset` to the offset of `input`; nothing if the number is not whole or not below
/// kMostSteps, or if coordinates within the bounds would not fit in 32 bits on the grid of `scale` and `offset`.
std::optional<std::int64_t> steps_between(const AxisOfInput& input, double scale, double offset) {
  if (input.field.scale == scale && input.field.bias == offset) return 0;
  const double distance = (input.field.bias - offset) / scale, steps = std::nearbyint(distance);
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(distance);
  if (!(std::abs(steps) < kMostSteps) || !(std::abs(distance - steps) < std::max(1e-6, rounding))) return std::nullopt;
  const double first = (input.lo - offset) / scale, last = (input.hi - offset) / scale;
  if (!(first > -2147483647.0 && last < 2147483646.0)) return std::nullopt;
  return static_cast<std::int64_t>(steps);
}

/// Finds the common grid of one axis.
class AxisGrid {
 public:
  explicit AxisGrid(std::vector<AxisOfInput> inputs) : inputs_(std::move(inputs)) {}

  bool find() {
    if (!std::ranges::all_of(inputs_, [](const AxisOfInput& i) { return is_grid(i.field); })) return false;
    scale = inputs_.front().field.scale;
    for (const AxisOfInput& input : inputs_) scale = std::min(scale, input.field.scale);
    for (const AxisOfInput& input : inputs_) {
      const auto factor = factor_between(input.field.scale, scale);
      if (!factor) return false;
      factors.push_back(*factor);
    }
    for (const double candidate : candidates()) {
      if (fits(candidate)) return true;
    }
    return false;
  }

  double scale = 1, offset = 0;
  std::vector<std::int64_t> factors, steps;  ///< one for each input

 private:
  std::vector<double> candidates() const {
    std::vector<double> offsets;
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const AxisOfInput& input : inputs_) {
      if (std::ranges::find(offsets, input.field.bias) == offsets.end()) offsets.push_back(input.field.bias);
      lo = std::min(lo, input.lo);
      hi = std::max(hi, input.hi);
    }
    const double first = inputs_.front().field.bias;
    const double steps_away = std::nearbyint((0.5 * lo + 0.5 * hi - first) / scale / kRoundSteps) * kRoundSteps;
    offsets.push_back(first + steps_away * scale);
    return offsets;
  }

  bool fits(double candidate) {
    offset = candidate;
    steps.clear();
    for (const AxisOfInput& input : inputs_) {
      const auto between = steps_between(input, scale, candidate);
      if (!between) return false;
      steps.push_back(*between);
    }
    return true;
  }

  std::vector<AxisOfInput> inputs_;
};

}  // namespace

void GridShift::run(std::span<std::byte> records, std::size_t stride, const std::filesystem::path& path) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (steps[axis] == 0 && factors[axis] == 1) continue;
    for (std::size_t at = offsets[axis]; at < records.size(); at += stride) {
      std::int32_t raw = 0;
      std::memcpy(&raw, records.data() + at, sizeof raw);
      const std::int64_t moved = raw * factors[axis] + steps[axis];
      if (moved != static_cast<std::int32_t>(moved)) {
        fail("{}: has points far outside the bounds in its header; correct the header or process the file alone.",
             path.string());
      }
      raw = static_cast<std::int32_t>(moved);
      std::memcpy(records.data() + at, &raw, sizeof raw);
    }
  }
}

std::optional<CommonGrid> common_grid(const std::vector<std::shared_ptr<Reader>>& readers) {
  CommonGrid common;
  common.shifts.resize(readers.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<AxisOfInput> inputs;
    for (const auto& reader : readers) {
      const Schema& schema = reader->info().schema;
      const Box box = reader->info().bounds.value_or(Box{});
      const int a = static_cast<int>(axis);
      inputs.push_back({schema.fields[*schema.find(kAxisNames[axis])], box.lo[a], box.hi[a]});
    }
    AxisGrid grid(inputs);
    if (!grid.find()) return std::nullopt;
    common.grid.scale[static_cast<int>(axis)] = grid.scale;
    common.grid.offset[static_cast<int>(axis)] = grid.offset;
    for (std::size_t i = 0; i < readers.size(); ++i) {
      common.shifts[i].offsets[axis] = inputs[i].field.offset;
      common.shifts[i].factors[axis] = grid.factors[i];
      common.shifts[i].steps[axis] = grid.steps[i];
    }
  }
  return common;
}

}  // namespace pointsweep
