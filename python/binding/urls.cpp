// SPDX-License-Identifier: MIT
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <vector>

#include "pointsweep/storage/remote/remote_service.h"
#include "pointsweep/url.h"
#include "python/binding/bindings.h"
#include "python/binding/python_threads.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

/// Returns (number of bytes, time of the last change in seconds since 1970, text that distinguishes versions); None if
/// there is no such object.
nb::object object_state(const std::string& url) {
  std::optional<RemoteVersion> found;
  {
    const Detached others_go_on;
    found = look_at(url);
  }
  if (!found) return nb::none();
  return nb::make_tuple(found->size, static_cast<double>(found->seconds) + found->nanoseconds * 1e-9, found->text());
}

/// Returns the bytes of an object; None if there is no such object.
nb::object get_object(const std::string& url) {
  std::vector<std::byte> bytes;
  std::optional<RemoteVersion> version;
  {
    const Detached others_go_on;
    version = look_at(url);
    if (version) {
      bytes.resize(version->size);
      if (!bytes.empty()) bytes.resize(read_remote(url, version, 0, bytes));
    }
  }
  if (!version) return nb::none();
  return nb::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// Returns whether the object was written. Without `overwrite`, an existing object stays unchanged.
bool put_object(const std::string& url, const nb::bytes& content, bool overwrite) {
  const std::span bytes(reinterpret_cast<const std::byte*>(content.c_str()), content.size());
  const Detached others_go_on;
  if (!overwrite) return put_remote_if_absent(url, bytes);
  put_remote(url, bytes, true);
  return true;
}

std::vector<std::string> list_objects(const std::string& folder) {
  const Detached others_go_on;
  std::vector<std::string> urls;
  for (const RemoteEntry& entry : list_remote(folder, true)) urls.push_back(entry.url);
  return urls;
}

void remove_object(const std::string& url) {
  const Detached others_go_on;
  remove_remote(url);
}

std::string known_name(const std::string& name) { return with_known_places(name); }

}  // namespace

void bind_urls(nb::module_& module) {
  module.def("reads_urls", &reads_urls);
  module.def("known_place", &known_name, "name"_a);
  module.def("object_state", &object_state, "url"_a);
  module.def("get_object", &get_object, "url"_a);
  module.def("put_object", &put_object, "url"_a, "content"_a, "overwrite"_a);
  module.def("list_objects", &list_objects, "folder"_a);
  module.def("remove_object", &remove_object, "url"_a);
}

}  // namespace pointsweep
