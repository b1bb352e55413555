// SPDX-License-Identifier: MIT
#include "python/binding/array_columns.h"

#include <optional>
#include <string_view>

#include "pointsweep/fail.h"

namespace nb = nanobind;

namespace pointsweep {
namespace {

/// Returns the type of a format letter of Python's module struct for values of `bytes` bytes; absent for other formats.
std::optional<Type> type_of_format(std::string_view format, std::ptrdiff_t bytes) {
  if (format.starts_with('@') || format.starts_with('=')) format.remove_prefix(1);
  if (format.size() != 1) return std::nullopt;
  constexpr Type kSigned[] = {Type::i8, Type::i16, Type::i32, Type::i64};
  constexpr Type kUnsigned[] = {Type::u8, Type::u16, Type::u32, Type::u64};
  const int size = bytes == 1 ? 0 : bytes == 2 ? 1 : bytes == 4 ? 2 : bytes == 8 ? 3 : -1;
  if (size < 0) return std::nullopt;
  const char letter = format.front();
  if (std::string_view("bhilq").find(letter) != std::string_view::npos) return kSigned[size];
  if (std::string_view("?BHILQ").find(letter) != std::string_view::npos) return kUnsigned[size];
  if (letter == 'f' && bytes == 4) return Type::f32;
  if (letter == 'd' && bytes == 8) return Type::f64;
  return std::nullopt;
}

/// Returns a shared buffer of the array. Its last owner acquires the interpreter lock and releases the buffer.
std::shared_ptr<Py_buffer> buffer_of(nb::handle array, int flags) {
  auto view = std::make_unique<Py_buffer>();
  if (PyObject_GetBuffer(array.ptr(), view.get(), flags | PyBUF_FORMAT) != 0) throw nb::python_error();
  return {view.release(), [](Py_buffer* held) {
            const nb::gil_scoped_acquire interpreter;
            PyBuffer_Release(held);
            delete held;
          }};
}

}  // namespace

ArrayColumn borrow_array(nb::handle array, std::vector<std::string> names) {
  const std::shared_ptr<Py_buffer> view = buffer_of(array, PyBUF_STRIDES);
  const auto type = type_of_format(view->format != nullptr ? view->format : "B", view->itemsize);
  if (!type) fail_usage("the array for '{}' does not hold numbers of at most 64 bits.", names.front());
  if (view->ndim != 2 || view->shape[1] != static_cast<Py_ssize_t>(names.size()))
    fail_usage("the array for '{}' does not have {} values for each point.", names.front(), names.size());
  return {.names = std::move(names),
          .type = *type,
          .first = static_cast<const std::byte*>(view->buf),
          .row_stride = view->strides[0],
          .value_stride = view->strides[1],
          .rows = static_cast<std::size_t>(view->shape[0]),
          .owner = view};
}

WritableArray borrow_writable(nb::handle array, const std::string& name) {
  const std::shared_ptr<Py_buffer> view = buffer_of(array, PyBUF_C_CONTIGUOUS | PyBUF_WRITABLE);
  const auto type = type_of_format(view->format != nullptr ? view->format : "B", view->itemsize);
  if (!type || view->ndim != 2) fail_usage("out: the array for '{}' does not hold numbers of at most 64 bits.", name);
  return {.type = *type,
          .first = static_cast<std::byte*>(view->buf),
          .rows = static_cast<std::size_t>(view->shape[0]),
          .values = static_cast<std::size_t>(view->shape[1]),
          .owner = view};
}

}  // namespace pointsweep
