// SPDX-License-Identifier: MIT
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <vector>

#include "pointsweep/program/generate.h"
#include "python/binding/bindings.h"
#include "python/binding/result_arrays.h"
#include "python/binding/watched_run.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

/// Converts the options of generate(). `options` has the keys seed, noise, outliers, outlier_box, origin (three numbers
/// or None) and float64.
Sampling sampling_of(std::uint64_t points, const nb::dict& options) {
  Sampling sampling{.count = points,
                    .seed = nb::cast<std::uint64_t>(options["seed"]),
                    .noise = nb::cast<double>(options["noise"]),
                    .outliers = nb::cast<double>(options["outliers"]),
                    .outlier_box = nb::cast<double>(options["outlier_box"]),
                    .float64 = nb::cast<bool>(options["float64"])};
  if (!options["origin"].is_none()) {
    const auto origin = nb::cast<std::vector<double>>(options["origin"]);
    sampling.origin = {origin.at(0), origin.at(1), origin.at(2)};
    sampling.float64 = true;
  }
  return sampling;
}

/// Returns a dict of arrays by name, or, if `path` is not empty, writes the file `path` and returns None. `options` has
/// the keys of sampling_of(), overwrite and threads.
nb::object generate(const std::string& shape, std::uint64_t points, const std::filesystem::path& path,
                    const nb::dict& options, const nb::object& progress, const nb::object& warn) {
  const std::unique_ptr<Reader> reader = generated_points(shape, sampling_of(points, options));
  OutputPlan plan;
  plan.path = path;
  plan.schema = reader->info().schema;
  plan.count = reader->info().count;
  plan.overwrite = nb::cast<bool>(options["overwrite"]);
  plan.bounds = reader->info().bounds;
  ResultArrays arrays({{{"xyz", {"x", "y", "z"}}, {"normal", {"nx", "ny", "nz"}}}, {}, false});
  const std::unique_ptr<Writer> writer = path.empty() ? arrays.writer(plan) : create_writer(plan);
  const auto threads = nb::cast<unsigned>(options["threads"]);
  watch_reports({progress, warn}, [&](Observer&, const Report& report) {
    write_generated(*reader, *writer, threads, [&](std::uint64_t done) { report("generating", done, plan.count); });
  });
  return path.empty() ? nb::object(arrays.arrays()) : nb::none();
}

std::vector<std::string> shape_names() {
  std::vector<std::string> names;
  for (const NamedShape& shape : shapes()) names.push_back(shape.name);
  return names;
}

}  // namespace

void bind_generate(nb::module_& module) {
  module.def("generate", &generate, "shape"_a, "points"_a, "path"_a, "options"_a, "progress"_a.none(), "warn"_a.none());
  module.def("shape_names", &shape_names);
}

}  // namespace pointsweep
