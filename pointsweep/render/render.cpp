// SPDX-License-Identifier: MIT
#include "pointsweep/program/render.h"

#include <fmt/format.h>

#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/colors/color_map.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/chosen_chunks.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/las_classes.h"
#include "pointsweep/render/cloud_sample.h"
#include "pointsweep/render/legend.h"
#include "pointsweep/render/point_color.h"
#include "pointsweep/render/point_shape.h"

namespace pointsweep {
namespace {

constexpr double kAmbient = 0.25;
constexpr double kBulge = 0.3;  // ProjectedEllipse::bulge of discs without a normal, in radii
// Limits of estimated radii, divided by the longer side of the picture without its legend: with normals, and without.
constexpr double kLargestOnSurface = 0.015, kLargestOfPoints = 0.006;
constexpr double kSmallestLimit = 3;       // least value of the limit of estimated radii, in pixels
constexpr double kSampleSeconds = 100e-9;  // seconds to fill a sample of the canvas under overlapping discs
constexpr double kFarOutliers = 4;         // see span_without_outliers()
constexpr std::uint64_t kMostPixels = 1u << 26;

void check(const RenderOptions& options) {
  const auto good = [](unsigned side) { return side >= 16 && side <= 16384; };
  if (good(options.width) && good(options.height) && std::uint64_t{options.width} * options.height <= kMostPixels)
    return;
  fail_usage("--size: {}x{} is no size of a picture; each side is 16 to 16384 pixels, both together at most {}.",
             options.width, options.height, kMostPixels);
}

/// Returns the cloud with its levels of detail up to the first one whose points are at most a pixel apart in a picture
/// that shows the longest side of the bounds as `pixels` pixels. Returns all points unless all inputs have levels of
/// detail and bounds.
InputCloud drawn_levels(const InputCloud& cloud, unsigned pixels) {
  Box bounds;
  double coarsest = 0;
  for (const auto& reader : cloud.readers()) {
    const FileInfo& info = reader->info();
    if (!info.root_spacing || !info.bounds) return cloud;
    bounds.include(*info.bounds);
    coarsest = std::max(coarsest, *info.root_spacing);
  }
  const Vec3 extent = bounds.extent();
  const double pixel = std::max({extent.x, extent.y, extent.z}) / pixels;
  const int depth = depth_of_spacing(coarsest, pixel);
  return cloud.with_chunks([&](const Chunk& chunk) { return chunk.depth <= depth; });
}

/// Returns the span from lo to hi, where all points lie. If it is more than kFarOutliers times the span of the middle
/// 99.8 % of the sampled `values`, and the middle span is not 0, returns the middle span, extended by 5 % on either
/// side but not beyond lo and hi: a few far points are then outside of the picture.
std::pair<double, double> span_without_outliers(std::vector<double>& values, double lo, double hi) {
  std::sort(values.begin(), values.end());
  const auto cut = static_cast<std::size_t>(0.001 * static_cast<double>(values.size()));
  const double middle_lo = values[cut], middle_hi = values[values.size() - 1 - cut], middle = middle_hi - middle_lo;
  if (hi - lo <= kFarOutliers * middle || middle == 0) return {lo, hi};
  return {std::max(lo, middle_lo - 0.05 * middle), std::min(hi, middle_hi + 0.05 * middle)};
}

void frame_cloud(Camera& camera, const std::vector<Vec3>& sample, const Extents& all, double margin) {
  std::vector<double> x, y;
  for (const Vec3 p : sample) {
    x.push_back(dot(p - camera.origin, camera.right));
    y.push_back(dot(p - camera.origin, camera.up));
  }
  const auto [lo_x, hi_x] = span_without_outliers(x, all.lo_x, all.hi_x);
  const auto [lo_y, hi_y] = span_without_outliers(y, all.lo_y, all.hi_y);
  frame(camera, lo_x, hi_x, lo_y, hi_y, margin);
}

bool is_inside(Vec3 pixel, const Camera& camera) {
  return pixel.x >= 0 && pixel.x <= camera.width && pixel.y >= 0 && pixel.y <= camera.height;
}

/// Returns an estimate of the seconds for drawing discs that cover the whole picture.
double fill_seconds(const RenderOptions& options, unsigned fineness) {
  return kSampleSeconds * options.width * options.height * fineness * fineness;
}

/// Returns the number of samples along each side of a pixel: fewer for large pictures, in which coarse edges are less
/// visible, and if the time limit is short.
unsigned fineness_of(const RenderOptions& options) {
  const std::uint64_t pixels = std::uint64_t{options.width} * options.height;
  unsigned fineness = pixels <= (1u << 22) ? 3 : pixels <= (1u << 24) ? 2 : 1;
  while (options.seconds > 0 && fineness > 1 && fill_seconds(options, fineness) > 0.5 * options.seconds) --fineness;
  return fineness;
}

/// Returns the rows to draw: all rows without a time limit, else as many as the limit allows.
RowStretches rows_of(InputCloud& cloud, const RenderOptions& options) {
  if (options.seconds <= 0) return all_rows(cloud);
  return rows_within(cloud, options.seconds - fill_seconds(options, fineness_of(options)));
}

/// Returns the direction up if the options state it, or z if the formats of all inputs state that it points up.
std::optional<Up> stated_up(const RenderOptions& options, const InputCloud& cloud) {
  const auto z_is_up = [](const auto& reader) { return reader->info().z_is_up; };
  return options.up ? options.up : std::ranges::all_of(cloud.readers(), z_is_up) ? std::optional(Up{}) : std::nullopt;
}

View view_of(const RenderOptions& options, const InputCloud& cloud, const std::vector<Vec3>& sample) {
  const std::optional<Up> stated = stated_up(options, cloud);
  const Up up = stated ? *stated : find_up(sample);
  return {options.angles ? *options.angles : is_flat(sample, up) ? kTop : kThreeQuarter, up};
}

/// Sets heights to 0, for a view from above: discs then follow the spacing on the map, so that the leaves of a crown do
/// not become large discs.
void flatten(std::vector<Vec3>& positions, Up up) {
  for (Vec3& p : positions) p[up.axis] = 0;
}

Legend legend_of(const PointColor& color, const RenderOptions& options) {
  Legend legend;
  if (!options.legend) return legend;
  legend.title = color.name();
  legend.unit = unit_of_attribute(color.name(), options.length_unit);
  legend.is_bar = color.is_number();
  legend.lo = color.lo();
  legend.hi = color.hi();
  for (const std::uint8_t code : color.classes())
    legend.entries.emplace_back(color_of_las_class(code), fmt::format("{} {}", code, name_of_las_class(code)));
  return legend;
}

/// A light from above the viewer's left shoulder. Surfaces have no back: the visible side is lit.
class Light {
 public:
  explicit Light(const Camera& camera) : toward_(camera.toward) {
    const Vec3 from = camera.toward + 0.45 * camera.up + (-0.35) * camera.right;
    from_ = (1 / length(from)) * from;
  }
  double on(Vec3 normal) const {
    const double facing = dot(normal, toward_) < 0 ? -1 : 1;
    return kAmbient + (1 - kAmbient) * std::max(0.0, facing * dot(normal, from_));
  }

 private:
  Vec3 toward_, from_;
};

}  // namespace

Rendering render(Cloud& inputs, const RenderOptions& options) {
  check(options);
  const std::uint64_t points = inputs.count();
  InputCloud cloud = drawn_levels(inputs.inputs(), std::max(options.width, options.height));
  const RowStretches rows = rows_of(cloud, options);
  const auto report = [&](const char* phase, std::uint64_t done) {
    if (options.progress) options.progress(phase, done, rows.count);
  };
  PointColor color(cloud.schema(), options.color);
  PossibleViews views(options.angles, stated_up(options, cloud));
  CloudSample sample = sample_cloud(cloud, rows, color, views, [&](std::uint64_t done) { report("looking", done); });
  if (sample.positions.empty())
    fail("{}: has no point with finite coordinates, so there is nothing to see.",
         cloud.readers().front()->info().path.string());
  const View view = view_of(options, cloud, sample.positions);
  color.settle({sample.positions, sample.records, cloud.schema().stride}, view.up, is_flat(sample.positions, view.up));
  const LegendColumn legend(legend_of(color, options), options.width, options.height, options.background);
  const unsigned room = options.width - legend.width();
  Camera camera = camera_of(view, sample.bounds.center(), room, options.height);
  frame_cloud(camera, sample.positions, views.extents(view, camera), 0.5 * options.point_size + 1);
  if (view.angles.elevation == 90) flatten(sample.positions, view.up);
  const SpacingTree spacing(std::move(sample.positions), sample.finite);
  const double largest = cloud.schema().find("nx") ? kLargestOnSurface : kLargestOfPoints;
  const double largest_guess = std::max(largest * std::max(room, options.height), kSmallestLimit) / camera.scale;
  const PointShape shape(cloud.schema(), spacing, camera.right, camera.up,
                         {.largest_guess = largest_guess, .fixed = 0.5 * options.point_size / camera.scale});
  const Light light(camera);
  std::uint64_t outside = 0;
  Canvas canvas(options.width, options.height, fineness_of(options), options.background);
  for_each_block(cloud, rows, [&](const PointBlock& block) {
    for (std::size_t i = 0; i < block.size; ++i) {
      stop_if_cancelled();
      const Vec3 p = block.position(i);
      if (!is_finite(p)) continue;
      const Vec3 pixel = camera.project(p);
      if (!is_inside(pixel, camera)) {
        ++outside;
        continue;
      }
      const SurfaceElement element = shape(block.record(i), p);
      const bool lit = color.is_shaded() && element.normal != Vec3{};
      const Rgb own = color(block.record(i), p);
      ProjectedEllipse ellipse{pixel, camera.project_offset(element.u), camera.project_offset(element.v)};
      if (element.normal == Vec3{}) ellipse.bulge = kBulge * camera.scale * length(element.u);
      canvas.draw(ellipse, lit ? shaded(own, light.on(element.normal)) : own);
    }
    report("drawing", block.first + block.size);
  });
  if (!shape.has_normals()) canvas.shade_by_depth();
  Rendering result{.picture = canvas.picture(),
                   .color = color.name(),
                   .is_number = color.is_number(),
                   .lo = color.lo(),
                   .hi = color.hi(),
                   .view = view,
                   .points = points,
                   .drawn = rows.count,
                   .outside = outside,
                   .remark = color.remark(),
                   .sample = std::move(sample.records)};
  legend.draw(result.picture);
  return result;
}

}  // namespace pointsweep
