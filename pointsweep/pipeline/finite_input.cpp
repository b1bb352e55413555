// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/finite_input.h"

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"

namespace pointsweep {
namespace {

bool holds_nonfinite(const Outputs& outputs) {
  const Format* const format = format_of_output(outputs.points);
  return format == nullptr || format->real_coordinates;
}

void require_allowed(const NonfiniteRows& found, const Outputs& outputs, Nonfinite rule) {
  if (rule == Nonfinite::refuse)
    fail("{} has coordinates that are not finite, as have {} points in all; --nonfinite drop leaves such points out.",
         found.first, found.count);
  if (rule == Nonfinite::keep)
    fail(
        "{} has coordinates that are not finite, and the output {} cannot hold them; leave such points out with "
        "--nonfinite drop, or write PLY.",
        found.first, outputs.points.string());
}

}  // namespace

Nonfinite nonfinite_rule(const Outputs& outputs, Nonfinite asked) {
  if (asked != Nonfinite::by_format) return asked;
  return holds_nonfinite(outputs) ? Nonfinite::keep : Nonfinite::drop;
}

FiniteInput::FiniteInput(InputCloud& cloud, const Outputs& outputs, const EngineOptions& options) : cloud_(cloud) {
  const Nonfinite rule = nonfinite_rule(outputs, options.nonfinite);
  if (rule == Nonfinite::keep && holds_nonfinite(outputs)) return;
  const std::uint64_t points = cloud.count();
  try {
    dropped_ = cloud.drop_nonfinite([&](std::uint64_t rows) {
      if (options.observer != nullptr) options.observer->on_progress({"checking", rows, points, 0});
    });
    if (dropped_.count == 0) return;
    require_allowed(dropped_, outputs, rule);
    if (cloud.count() == 0)
      fail("{}: none of the {} points has finite coordinates, so nothing is left to write.",
           cloud.readers().front()->info().path.string(), dropped_.count);
  } catch (...) {
    cloud.keep_all();
    throw;
  }
}

FiniteInput::~FiniteInput() { cloud_.keep_all(); }

std::string FiniteInput::warning() const {
  if (dropped_.count == 0) return "";
  return fmt::format("Dropped {} {} whose coordinates are not finite, the first {}; --stats FILE lists their rows.",
                     dropped_.count, dropped_.count == 1 ? "point" : "points", dropped_.first);
}

}  // namespace pointsweep
