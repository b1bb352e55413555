// SPDX-License-Identifier: MIT
#include "python/binding/generated.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <thread>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/shapes/registry.h"
#include "pointsweep/shapes/shape_reader.h"
#include "pointsweep/threads.h"
#include "python/binding/result_arrays.h"
#include "python/binding/watched_run.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

constexpr std::size_t kGeneratedRows = 1 << 18;  // made at once

void write_all(Reader& reader, Writer& writer, Observer& observer) {
  const std::size_t stride = reader.info().schema.stride;
  const std::uint64_t total = reader.info().count;
  std::vector<std::byte> block(kGeneratedRows * stride);
  for (std::uint64_t row = 0; row < total;) {
    stop_if_cancelled();
    const std::size_t made = reader.read(row, block);
    writer.write(std::span(block).first(made * stride));
    row += made;
    observer.on_progress({"generating", row, total, 0});
  }
  writer.finish();
}

/// `options`: seed, noise, outliers, outlier_box, origin (three numbers or None), float64, overwrite, threads.
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

/// Arrays by name, or None if `path` names a file to write.
nb::object generate(const std::string& shape, std::uint64_t points, const std::filesystem::path& path,
                    const nb::dict& options, const nb::object& progress, const nb::object& warn) {
  ShapeReader reader(create_shape(shape), sampling_of(points, options));
  OutputPlan plan;
  plan.path = path;
  plan.schema = reader.info().schema;
  plan.count = reader.info().count;
  plan.overwrite = nb::cast<bool>(options["overwrite"]);
  plan.bounds = reader.info().bounds;
  ResultArrays arrays({{{"xyz", {"x", "y", "z"}}, {"normal", {"nx", "ny", "nz"}}}, {}, false});
  const std::unique_ptr<Writer> writer = path.empty() ? arrays.writer(plan) : create_writer(plan);
  const auto threads = nb::cast<unsigned>(options["threads"]);
  watch({progress, warn}, [&](Observer& observer) {
    const CancellationScope scope(&observer.token());
    with_threads(threads != 0 ? threads : std::max(1u, std::thread::hardware_concurrency()),
                 [&] { write_all(reader, *writer, observer); });
  });
  return path.empty() ? nb::object(arrays.arrays()) : nb::none();
}

std::vector<std::string> shape_names() {
  std::vector<std::string> names;
  for (const auto& shape : all_shapes()) names.emplace_back(shape->name());
  return names;
}

}  // namespace

void bind_generate(nb::module_& module) {
  module.def("generate", &generate, "shape"_a, "points"_a, "path"_a, "options"_a, "progress"_a.none(), "warn"_a.none());
  module.def("shape_names", &shape_names);
}

}  // namespace pointsweep
