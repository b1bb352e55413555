// SPDX-License-Identifier: MIT
#include "python/binding/errors.h"

#include <nanobind/nanobind.h>

#include "pointsweep/error.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

void raise(const char* name, const std::exception& error) {
  const nb::module_ errors = nb::module_::import_("pointsweep._errors");
  const nb::object sentence = errors.attr("with_names_of_python")(error.what());
  PyErr_SetObject(errors.attr(name).ptr(), sentence.ptr());
}

}  // namespace

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

}  // namespace pointsweep
