// SPDX-License-Identifier: MIT
/// Two parts of the JSON object that `info --json` writes: the object of a file, and the statistics of points.
#include <nlohmann/json.hpp>

#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/info.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

using Json = nlohmann::ordered_json;

Json vector_of(Vec3 v) { return {v.x + 0.0, v.y + 0.0, v.z + 0.0}; }  // adding 0 turns -0 into 0

Json number_or_null(std::optional<double> value) { return value ? Json(*value) : Json(); }

Json axes(const std::array<bool, 3>& ordered, Vec3 extent) {
  Json names = Json::array();
  for (int axis = 0; axis < 3; ++axis)
    if (ordered[static_cast<std::size_t>(axis)] && extent[axis] > 0) names.push_back(std::string(1, "xyz"[axis]));
  return names;
}

Json attributes(const Schema& schema, const FileSummary& summary) {
  Json list = Json::array();
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    const Field& field = schema.fields[f];
    const FieldRange& range = summary.ranges[f];
    const bool any = range.lo <= range.hi;
    list.push_back({{"name", field.name},
                    {"type", name_of(field.type)},
                    {"count", field.count},
                    {"scale", field.scale},
                    {"offset", field.bias},
                    {"min", any ? Json(range.lo) : Json()},
                    {"max", any ? Json(range.hi) : Json()},
                    {"nonfinite", range.nonfinite}});
  }
  return list;
}

template <std::size_t N>
Json counts(const std::array<std::uint64_t, N>& points, bool there) {
  if (!there) return {};
  Json object = Json::object();
  for (std::size_t value = 0; value < N; ++value)
    if (points[value] > 0) object[std::to_string(value)] = points[value];
  return object;
}

Json gps_time(const FileSummary& summary) {
  const auto times = gps_times(summary);
  if (!times) return {};
  constexpr const char* kClocks[] = {"week_seconds", "adjusted_standard", "unknown"};
  const auto date = [&](double t) {
    const std::string text = times->clock == GpsClock::adjusted_standard ? gps_date(t) : "";
    return text.empty() ? Json() : Json(text);
  };
  return {{"min", times->lo},
          {"max", times->hi},
          {"clock", kClocks[static_cast<int>(times->clock)]},
          {"from", date(times->lo)},
          {"to", date(times->hi)}};
}

Json crs_of(const std::optional<Crs>& crs) {
  if (!crs) return {};
  const auto code = [](int epsg) { return epsg == 0 ? Json() : Json(epsg); };
  const auto text = [](const std::string& words) { return words.empty() ? Json() : Json(words); };
  return {{"name", text(crs->name)},
          {"epsg", code(crs->epsg)},
          {"vertical_epsg", code(crs->vertical_epsg)},
          {"length_unit", text(length_unit_of(*crs))},
          {"wkt", text(crs->wkt)}};
}

Json json_of(const ProvenanceRecord& record) {
  Json settings = Json::object(), inputs = Json::array();
  for (const auto& [name, value] : record.settings) settings[name] = value;
  for (const ProvenanceInput& input : record.inputs)
    inputs.push_back({{"name", input.name}, {"points", input.points}, {"bytes", input.bytes}});
  return {{"version", record.version},
          {"stages", record.stages},
          {"settings", settings},
          {"inputs", inputs},
          {"more_inputs", record.more_inputs}};
}

/// Returns the runs that made the file, as far as it records them, oldest first.
Json provenance(const FileInfo& info) {
  Json records = Json::array();
  for (const ProvenanceRecord& record : records_of(info.provenance)) records.push_back(json_of(record));
  return records;
}

Json value_or_null(const std::optional<AttributeValue>& value) {
  return value ? std::visit([](auto v) { return Json(v); }, *value) : Json();
}

Json json_of(const AttributeStatistics& a) {
  Json quantiles = Json::array();
  for (const AttributeValue& value : a.quantiles) quantiles.push_back(value_or_null(value));
  return {{"name", a.name},
          {"type", name_of(a.type)},
          {"count", a.count},
          {"nonfinite", a.nonfinite},
          {"min", value_or_null(a.min)},
          {"max", value_or_null(a.max)},
          {"mean", number_or_null(a.mean)},
          {"deviation", number_or_null(a.deviation)},
          {"quantiles", a.quantiles.empty() ? Json() : quantiles}};
}

Json json_of(const PointGroup& group) {
  Json attributes = Json::array(), histograms = Json::array();
  for (const AttributeStatistics& a : group.attributes) attributes.push_back(json_of(a));
  for (const AttributeHistogram& h : group.histograms)
    histograms.push_back({{"name", h.name}, {"edges", h.edges}, {"counts", h.counts}});
  return {{"value", value_or_null(group.value)},
          {"points", group.points},
          {"attributes", attributes},
          {"histograms", histograms}};
}

Json json_of(const PointStatistics& statistics) {
  Json groups = Json::array();
  for (const PointGroup& group : statistics.groups) groups.push_back(json_of(group));
  return {{"points", statistics.points},
          {"by", statistics.by.empty() ? Json() : Json(statistics.by)},
          {"percent", PointStatistics::kPercent},
          {"groups", groups}};
}

Json json_of(const Box& bounds) {
  if (bounds.empty()) return {};
  return {{"min", vector_of(bounds.lo)}, {"max", vector_of(bounds.hi)}};
}

Json json_of(const FileSummary& s) {
  const FileInfo& info = s.info;
  const PositionFields p = position_fields(info.schema, info.path.string());
  const Vec3 extent = s.bounds.extent();
  return {{"path", info.path.string()},
          {"format", info.format},
          {"bytes", info.bytes},
          {"points", info.count},
          {"read", s.of_header ? "header" : "points"},
          {"nonfinite", s.of_header ? Json() : Json(s.nonfinite)},
          {"bounds", json_of(s.bounds)},
          {"crs", crs_of(info.crs)},
          {"scale", vector_of({p.x.scale, p.y.scale, p.z.scale})},
          {"offset", vector_of({p.x.bias, p.y.bias, p.z.bias})},
          {"density", number_or_null(s.density())},
          {"density_cell", s.area > 0 ? Json(s.cell_side) : Json()},
          {"spacing", number_or_null(s.spacing())},
          {"spacing_sample", s.nearest.size()},
          {"spacing_duplicates", s.duplicates()},
          {"ascending", s.of_header ? Json() : axes(s.ascending, extent)},
          {"descending", s.of_header ? Json() : axes(s.descending, extent)},
          {"classes", counts(s.classes, s.has_classes)},
          {"returns", counts(s.returns, s.has_returns)},
          {"gps_time", gps_time(s)},
          {"attributes", attributes(info.schema, s)},
          {"provenance", provenance(info)},
          {"warnings", info.warnings}};
}

}  // namespace

std::string to_json(const PointStatistics& statistics) {
  return json_of(statistics).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string to_json(const FileSummary& summary) {
  return json_of(summary).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace pointsweep
