// SPDX-License-Identifier: MIT
#include "python/binding/pictures.h"

#include <nanobind/stl/string.h>

#include <cstdint>
#include <string>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/program/render.h"
#include "pointsweep/render/canvas.h"
#include "python/binding/requests.h"
#include "python/binding/watched_run.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

/// Converts the options of a picture. `given` has every key that pointsweep._render.render() gives.
RenderOptions render_options(const nb::dict& given) {
  RenderOptions options;
  options.width = nb::cast<unsigned>(given["width"]);
  options.height = nb::cast<unsigned>(given["height"]);
  options.angles = parse_view(nb::cast<std::string>(given["view"]));
  options.up = parse_up(nb::cast<std::string>(given["up"]));
  options.color = nb::cast<std::string>(given["color"]);
  options.point_size = nb::cast<double>(given["point_size"]);
  options.background = parse_color(nb::cast<std::string>(given["background"]));
  options.legend = nb::cast<bool>(given["legend"]);
  return options;
}

/// Returns (bytes of the PNG, source of the colours, (lo, hi) if the colours show numbers or else None, number of
/// points outside of the picture).
nb::tuple render_picture(const nb::list& source, const nb::dict& given, const nb::object& progress,
                         const nb::object& warn) {
  Cloud cloud = open_cloud(source, true, given);
  RenderOptions options = render_options(given);
  if (const auto& crs = cloud.inputs().crs()) options.length_unit = length_unit_of(*crs);
  Rendering made;
  std::vector<std::byte> png;
  watch({progress, warn}, [&](Observer& observer) {
    const CancellationScope scope(&observer.token());
    options.progress = [&](const char* phase, std::uint64_t done, std::uint64_t total) {
      stop_if_cancelled();
      observer.on_progress({phase, done, total, 0});
    };
    made = render(cloud, options);
    png = to_png(made.picture);
  });
  const nb::object range = made.is_number ? nb::object(nb::make_tuple(made.lo, made.hi)) : nb::none();
  return nb::make_tuple(nb::bytes(reinterpret_cast<const char*>(png.data()), png.size()), made.color, range,
                        made.outside);
}

}  // namespace

void bind_pictures(nb::module_& module) {
  module.def("render", &render_picture, "source"_a, "options"_a, "progress"_a.none(), "warn"_a.none());
}

}  // namespace pointsweep
