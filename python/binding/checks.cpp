// SPDX-License-Identifier: MIT
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/info.h"
#include "pointsweep/program/render.h"
#include "pointsweep/render/canvas.h"
#include "pointsweep/verify.h"
#include "python/binding/bindings.h"
#include "python/binding/crs_values.h"
#include "python/binding/requests.h"
#include "python/binding/watched_run.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

/// Returns (summary of the file as JSON, its coordinate reference system).
nb::tuple summarize_file(const std::filesystem::path& path, const std::string& format, bool spacing,
                         const nb::object& progress) {
  FileSummary summary;
  watch_reports({progress, nb::none()}, [&](Observer&, const Report& report) {
    const std::unique_ptr<Reader> reader = open_reader(path, format);
    const auto read = [&](std::uint64_t done, std::uint64_t total) { report("reading", done, total); };
    summary = summarize(*reader, {.spacing = spacing, .progress = read});
  });
  return nb::make_tuple(to_json(summary), crs_value(summary.info.crs));
}

/// Returns the statistics as JSON. `given` has every key that pointsweep._summary.summary() gives.
std::string statistics_of_points(const nb::list& source, const nb::dict& given, const nb::object& progress,
                                 const nb::object& warn) {
  Cloud cloud = open_cloud(source, false, given);
  PointStatisticsOptions options;
  options.by = nb::cast<std::string>(given["by"]);
  options.values = nb::cast<bool>(given["values"]);
  options.keep = nb::cast<std::vector<std::string>>(given["keep"]);
  options.histograms = nb::cast<std::vector<std::string>>(given["histograms"]);
  options.bins = nb::cast<std::uint64_t>(given["bins"]);
  PointStatistics statistics;
  watch_reports({progress, warn}, [&](Observer& observer, const Report& report) {
    for (const std::string& warning : cloud.warnings()) observer.on_warning(warning);
    options.progress = [&](unsigned, std::uint64_t done, std::uint64_t total) { report("reading", done, total); };
    statistics = point_statistics(cloud, options);
  });
  return to_json(statistics);
}

/// Converts pairs of Python, (name, value) with an int or a float as value, to options.
Options options_of(const nb::list& pairs) {
  Options options;
  for (const nb::handle pair : pairs) {
    const nb::handle value = pair[1];
    const bool is_whole = nb::isinstance<nb::int_>(value);
    options.push_back({nb::cast<std::string>(pair[0]),
                       is_whole ? OptionValue(nb::cast<std::uint64_t>(value)) : OptionValue(nb::cast<double>(value))});
  }
  return options;
}

/// Converts the options of a verification. `options` has every key that pointsweep._verify.verify() gives.
VerifyOptions verify_options(const nb::dict& options) {
  VerifyOptions check;
  check.sample = nb::cast<std::uint64_t>(options["sample"]);
  check.seed = nb::cast<std::uint64_t>(options["seed"]);
  check.rows = nb::cast<std::vector<std::uint64_t>>(options["rows"]);
  const RunOptions run = run_options(options);
  if (!nb::cast<std::string>(options["order"]).empty()) check.order = run.order;
  check.axis = run.axis;
  check.nonfinite = run.nonfinite;
  check.prefix = run.prefix;
  check.decimals = run.layout.decimals;
  check.positions = run.positions;
  check.division = run.division;
  if (run.resources.memory_bytes != 0) check.memory_bytes = run.resources.memory_bytes;
  check.pipeline = nb::cast<std::string>(options["pipeline"]);
  check.neighborhood = options_of(nb::cast<nb::list>(options["neighborhood"]));
  check.keep = nb::cast<std::vector<std::string>>(options["keep"]);
  check.recursive = nb::cast<bool>(options["recursive"]);
  check.cloud.ignore_crs = nb::cast<bool>(options["ignore_crs"]);
  check.cloud.format = nb::cast<std::string>(options["format"]);
  return check;
}

nb::dict verdict_values(const Verdict& v) {
  nb::dict values;
  values["input"] = v.input;
  values["output"] = v.output;
  values["same"] = v.same();
  values["complete"] = v.is_complete();
  values["points"] = v.arrivals.points_out;
  values["order"] = v.order;
  values["computed"] = v.made;
  values["by_own_operator"] = v.by_own_operator;
  values["samples"] = v.sampled;
  values["wrong_samples"] = v.wrong_points;
  values["values"] = v.values;
  values["open_values"] = v.open_values;
  values["different_rows"] = v.different_rows;
  values["difference_count"] = v.difference_count;
  values["differences"] = v.differences;
  values["unknown"] = v.unknown;
  values["not_checked"] = v.untold;
  values["conclusion"] = conclusion(v);
  values["text"] = to_text(v);
  return values;
}

nb::dict verify_files(const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& output,
                      const nb::dict& options, const nb::object& progress) {
  VerifyOptions check = verify_options(options);
  Verdict verdict;
  watch_reports({progress, nb::none()}, [&](Observer&, const Report& report) {
    check.progress = report;
    verdict = verify(inputs, output, check);
  });
  return verdict_values(verdict);
}

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
  watch_reports({progress, warn}, [&](Observer&, const Report& report) {
    options.progress = report;
    made = render(cloud, options);
    png = to_png(made.picture);
  });
  const nb::object range = made.is_number ? nb::object(nb::make_tuple(made.lo, made.hi)) : nb::none();
  return nb::make_tuple(nb::bytes(reinterpret_cast<const char*>(png.data()), png.size()), made.color, range,
                        made.outside);
}

}  // namespace

void bind_checks(nb::module_& module) {
  module.def("summarize", &summarize_file, "path"_a, "format"_a, "spacing"_a, "progress"_a.none());
  module.def("statistics", &statistics_of_points, "source"_a, "options"_a, "progress"_a.none(), "warn"_a.none());
  module.def("verify", &verify_files, "inputs"_a, "output"_a, "options"_a, "progress"_a.none());
  module.def("render", &render_picture, "source"_a, "options"_a, "progress"_a.none(), "warn"_a.none());
}

}  // namespace pointsweep
