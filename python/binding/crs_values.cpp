// SPDX-License-Identifier: MIT
#include "python/binding/crs_values.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/formats/crs.h"
#include "python/binding/bindings.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace pointsweep {
namespace {

/// Returns the text as a str. Bytes that are not UTF-8, which files may hold, become U+FFFD.
nb::object text(const std::string& bytes) {
  return nb::steal(PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "replace"));
}

template <class T>
std::vector<T> elements(const nb::bytes& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.c_str(), values.size() * sizeof(T));
  return values;
}

/// Returns the system that the WKT describes; None if neither a name nor a kind of system is found in the text.
nb::object wkt_crs(const std::string& wkt) {
  const Crs crs = crs_of_wkt(wkt);
  return crs.name.empty() && crs.kind == CrsKind::unknown ? nb::none() : crs_value(crs);
}

/// Returns the coordinate reference system that the WKT and GeoTIFF records of a LAS file state.
nb::object las_crs(const nb::bytes& wkt, const nb::bytes& directory, const nb::bytes& doubles, const nb::bytes& ascii,
                   bool wkt_counts) {
  GeoTiffKeys keys{elements<std::uint16_t>(directory), elements<double>(doubles), {ascii.c_str(), ascii.size()}};
  return crs_value(crs_of_both({wkt.c_str(), wkt.size()}, std::move(keys), wkt_counts));
}

}  // namespace

nb::object crs_value(const std::optional<Crs>& crs) {
  if (!crs) return nb::none();
  const GeoTiffKeys& keys = crs->geotiff;
  return nb::make_tuple(text(crs->name), static_cast<int>(crs->kind), crs->epsg, crs->vertical_epsg, text(crs->wkt),
                        nb::tuple(nb::cast(keys.directory)), nb::tuple(nb::cast(keys.doubles)),
                        nb::bytes(keys.ascii.data(), keys.ascii.size()));
}

std::optional<Crs> crs_from(nb::handle value) {
  if (value.is_none()) return std::nullopt;
  const auto ascii = nb::cast<nb::bytes>(value[7]);
  return Crs{.name = nb::cast<std::string>(value[0]),
             .kind = static_cast<CrsKind>(nb::cast<int>(value[1])),
             .epsg = nb::cast<int>(value[2]),
             .vertical_epsg = nb::cast<int>(value[3]),
             .wkt = nb::cast<std::string>(value[4]),
             .geotiff = {nb::cast<std::vector<std::uint16_t>>(value[5]),
                         nb::cast<std::vector<double>>(value[6]),
                         {ascii.c_str(), ascii.size()}}};
}

void bind_crs(nb::module_& module) {
  module.def("wkt_crs", &wkt_crs, "wkt"_a);
  module.def(
      "parse_crs", [](const std::string& text) { return crs_value(parse_crs(text)); }, "text"_a);
  module.def("las_crs", &las_crs, "wkt"_a, "directory"_a, "doubles"_a, "ascii"_a, "wkt_counts"_a);
  module.def(
      "short_text", [](nb::handle crs) { return text(short_text(*crs_from(crs))); }, "crs"_a);
  module.def(
      "differ",
      [](nb::handle a, nb::handle b) { return compare(*crs_from(a), *crs_from(b)) == CrsAgreement::different; }, "a"_a,
      "b"_a);
}

}  // namespace pointsweep
