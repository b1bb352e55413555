// SPDX-License-Identifier: MIT
#include "pointsweep/files.h"

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "pointsweep/program/formats.h"
#include "python/binding/bindings.h"
#include "python/binding/crs_values.h"
#include "python/binding/python_threads.h"
#include "python/binding/requests.h"
#include "python/binding/result_arrays.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

/// Returns (pairs of a path and its name in a folder of outputs, notices about files that are left out).
nb::tuple list_files(const std::vector<std::filesystem::path>& named, bool recursive, const std::string& format) {
  const InputList list = [&] {
    const Detached others_go_on;
    return list_inputs(named, recursive, format);
  }();
  nb::list files;
  for (const ListedFile& file : list.files) files.append(nb::make_tuple(file.path.string(), file.relative.string()));
  return nb::make_tuple(files, list.notices);
}

/// Returns the bounds in the headers, ((x, y, z), (x, y, z)); None if a file with points states none, or if no file has
/// points.
nb::object stated_bounds(const Cloud& cloud) {
  Box box;
  for (std::size_t i = 0; i < cloud.input_count(); ++i) {
    const FileInfo& input = cloud.input(i);
    if (input.count == 0) continue;
    if (!input.bounds) return nb::none();
    box.include(*input.bounds);
  }
  if (box.empty()) return nb::none();
  const auto corner = [](Vec3 p) { return nb::make_tuple(p.x, p.y, p.z); };
  return nb::make_tuple(corner(box.lo), corner(box.hi));
}

/// Returns the facts in the headers of the files. Reads no points.
nb::dict describe(const nb::list& source, const nb::dict& options) {
  const Cloud cloud = open_cloud(source, false, options);
  nb::list attributes, inputs, warnings;
  for (const Field& field : cloud.schema().fields)
    attributes.append(nb::make_tuple(field.name, std::string(name_of(result_type(field))), field.count));
  for (std::size_t i = 0; i < cloud.input_count(); ++i) {
    const FileInfo& input = cloud.input(i);
    inputs.append(nb::make_tuple(input.path.string(), input.format, input.count));
    for (const std::string& warning : input.warnings) warnings.append(warning);
  }
  for (const std::string& warning : cloud.warnings()) warnings.append(warning);
  nb::dict known;
  known["count"] = cloud.count();
  known["attributes"] = attributes;
  known["inputs"] = inputs;
  known["warnings"] = warnings;
  known["bounds"] = stated_bounds(cloud);
  known["crs"] = crs_value(cloud.crs());
  return known;
}

}  // namespace

void bind_files(nb::module_& module) {
  module.def("list_files", &list_files, "named"_a, "recursive"_a, "format"_a);
  module.def("describe", &describe, "source"_a, "options"_a);
  module.def("extension_of", &extension_of, "name"_a);
}

}  // namespace pointsweep
