// SPDX-License-Identifier: MIT
/// The extension module pointsweep._core, which the Python layer in pointsweep/ calls. It checks types; the Python
/// layer completes arguments and explains errors.
#include <nanobind/nanobind.h>

#include "pointsweep/error.h"
#include "python/binding/bindings.h"
#include "python/binding/python_threads.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

void raise(const char* name, const std::exception& error) {
  const nb::module_ errors = nb::module_::import_("pointsweep._errors");
  const nb::object sentence = errors.attr("with_names_of_python")(error.what());
  PyErr_SetObject(errors.attr(name).ptr(), sentence.ptr());
}

/// Translates Error and UsageError to the classes of these names in pointsweep._errors.
void translate_errors() {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const UsageError& error) {
      raise("UsageError", error);
    } catch (const Error& error) {
      raise("Error", error);
    }
  });
}

}  // namespace
}  // namespace pointsweep

NB_MODULE(_core, module) {
  using namespace pointsweep;
  module.doc() = "The library behind the package pointsweep. Use the functions of the package.";
  module.attr("version") = POINTSWEEP_VERSION;
  translate_errors();
  bind_point_batch(module);
  bind_runs(module);
  bind_files(module);
  bind_urls(module);
  bind_generate(module);
  bind_crs(module);
  bind_checks(module);
  bind_parts(module);
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(attach_no_more));
}
