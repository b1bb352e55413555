// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/pcd/pcd_format.h"
#include "pointsweep/formats/records/record_writer.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {
namespace {

bool is_byte(const Field& field) {
  const bool plain_byte = field.bit_width == 0 && field.type == Type::u8;
  return field.scale == 1 && field.bias == 0 && field.count == 1 &&
         (plain_byte || (field.bit_width > 0 && field.bit_width <= 8));
}

/// Returns the type in the file: float64 for scaled values, the smallest possible integer for bit fields.
Type pcd_type(const Field& field) {
  if (field.scale != 1 || field.bias != 0) return Type::f64;
  return unpacked_type(field);
}

char pcd_kind(Type type) {
  if (type == Type::f32 || type == Type::f64) return 'F';
  return name_of(type).starts_with('u') ? 'U' : 'I';
}

/// The record of a file, and the lines of its header that describe it.
struct PcdLayout {
  Schema stored;  ///< fields under the names of the plan
  std::string names = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";

  void describe(std::string_view name, std::size_t size, char kind, std::uint32_t count) {
    names += fmt::format(" {}", name);
    sizes += fmt::format(" {}", size);
    types += fmt::format(" {}", kind);
    counts += fmt::format(" {}", count);
  }
};

/// Returns the indices of red, green, blue and perhaps alpha, if the first three are bytes.
std::vector<std::size_t> byte_colors(const Schema& schema) {
  std::vector<std::size_t> found;
  for (const char* name : {"red", "green", "blue", "alpha"}) {
    const auto index = schema.find(name);
    if (index && is_byte(schema.fields[*index])) found.push_back(*index);
    if (found.empty() || (found.size() < 3 && name == std::string_view("blue"))) return {};
  }
  return found;
}

/// Packs colours into one word: blue in its lowest byte, then green, red and alpha.
void pack_colors(const Schema& schema, const std::vector<std::size_t>& colors, PcdLayout& layout) {
  constexpr std::array<std::uint32_t, 4> kBytes{2, 1, 0, 3};
  for (std::size_t c = 0; c < colors.size(); ++c)
    layout.stored.fields.push_back(
        {.name = schema.fields[colors[c]].name, .type = Type::u8, .offset = layout.stored.stride + kBytes[c]});
  layout.stored.stride += 4;
  colors.size() == 4 ? layout.describe("rgba", 4, 'U', 1) : layout.describe("rgb", 4, 'F', 1);
}

/// Returns one name for each field; the line COUNT states the number of its components. Names that mean packed colours
/// or padding in PCD get their type appended.
std::vector<std::string> pcd_names(const Schema& schema) {
  Schema named;
  for (const Field& field : schema.fields) {
    const bool has_a_meaning = field.name == "rgb" || field.name == "rgba" || field.name == "_";
    named.append(has_a_meaning ? fmt::format("{}_{}", field.name, name_of(field.type)) : pcd_field_name(field.name),
                 field.type);
  }
  return column_names(named);
}

PcdLayout pcd_layout(const OutputPlan& plan) {
  PcdLayout layout;
  const Schema& schema = plan.schema;
  const std::vector<std::size_t> colors = byte_colors(schema);
  const std::vector<std::string> names = pcd_names(schema);
  for (std::size_t f = 0; f < schema.fields.size(); ++f) {
    const Field& field = schema.fields[f];
    if (std::ranges::find(colors, f) != colors.end()) {
      if (f == *std::ranges::min_element(colors)) pack_colors(schema, colors, layout);
      continue;
    }
    const Type type = pcd_type(field);
    layout.stored.append(field.name, type, field.count);
    layout.describe(names[f], size_of(type), pcd_kind(type), field.count);
  }
  return layout;
}

/// Returns the viewpoint of the inputs if all are PCD files and agree; the identity otherwise.
std::string viewpoint_of(const OutputPlan& plan) {
  const auto stated = [](const auto& extras) {
    const auto* const pcd = extras_as<PcdExtras>(extras);
    return pcd == nullptr ? std::string() : pcd->viewpoint;
  };
  const std::string first = stated(plan.extras);
  const bool agree = std::ranges::all_of(plan.other_extras, [&](const auto& other) { return stated(other) == first; });
  return agree && !first.empty() ? first : "VIEWPOINT 0 0 0 1 0 0 0";
}

std::string pcd_header_text(const OutputPlan& plan) {
  const PcdLayout layout = pcd_layout(plan);
  std::string header = "# .PCD v0.7 - Point Cloud Data file format\n";
  for (const std::string& line : plan.provenance) header += "# " + line + "\n";
  return header + fmt::format("VERSION 0.7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT 1\n{}\nPOINTS {}\nDATA binary\n",
                              layout.names, layout.sizes, layout.types, layout.counts, plan.count, viewpoint_of(plan),
                              plan.count);
}

class PcdWriter final : public RecordWriter {
 public:
  explicit PcdWriter(const OutputPlan& plan) : RecordWriter(plan, pcd_header_text(plan), pcd_layout(plan).stored) {
    if (std::string changed = changed_names(plan.path, "PCD", plan.schema, column_names(plan.schema)); !changed.empty())
      add_warning(std::move(changed));
  }
};

constexpr std::string_view kPcdExtensions[] = {".pcd"};

}  // namespace

std::string pcd_field_name(const std::string& name) {
  for (const char* normal : {"nx", "ny", "nz"})
    if (name == normal) return std::string("normal_") + normal[1];
  return name;
}

std::unique_ptr<Writer> create_pcd_writer(const OutputPlan& plan) { return std::make_unique<PcdWriter>(plan); }

const Format kPcdFormat = {.name = "PCD",
                           .title = "PCD",
                           .details = "#pcd",
                           .reads = "ascii, binary, binary_compressed; versions .5 to 0.7",
                           .writes = "binary, version 0.7",
                           .extensions = kPcdExtensions,
                           .is = starts_as_pcd,
                           .open = open_pcd,
                           .create = create_pcd_writer,
                           .holds_provenance = true,
                           .is_sequential = true,
                           .stored_name = pcd_field_name};

}  // namespace pointsweep
