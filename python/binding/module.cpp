// SPDX-License-Identifier: MIT
/// The extension module pointsweep._core, which the Python layer in pointsweep/ calls. It checks types; the Python
/// layer completes arguments and explains errors.
#include <nanobind/nanobind.h>

#include "python/binding/checks.h"
#include "python/binding/crs_values.h"
#include "python/binding/errors.h"
#include "python/binding/files.h"
#include "python/binding/generated.h"
#include "python/binding/parts.h"
#include "python/binding/pictures.h"
#include "python/binding/point_batch.h"
#include "python/binding/runs.h"
#include "python/binding/urls.h"

NB_MODULE(_core, module) {
  module.doc() = "The library behind the package pointsweep. Use the functions of the package.";
  module.attr("version") = POINTSWEEP_VERSION;
  pointsweep::translate_errors();
  pointsweep::bind_point_batch(module);
  pointsweep::bind_runs(module);
  pointsweep::bind_files(module);
  pointsweep::bind_urls(module);
  pointsweep::bind_generate(module);
  pointsweep::bind_crs(module);
  pointsweep::bind_checks(module);
  pointsweep::bind_parts(module);
  pointsweep::bind_pictures(module);
}
