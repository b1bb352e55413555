// SPDX-License-Identifier: MIT
#include <cstring>
#include <limits>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/ply/ply_format.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/formats/records/record_writer.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/row_error.h"

namespace pointsweep {
namespace {

bool is_wide(Type type) { return type == Type::i64 || type == Type::u64; }

Type stored_type(const Field& field, bool keeps_wide) {
  if (field.scale != 1 || field.bias != 0) return Type::f64;
  const Type type = unpacked_type(field);
  return is_wide(type) && !keeps_wide ? Type::f64 : type;
}

const PlyExtras* ply_extras(const OutputPlan& plan) { return extras_as<PlyExtras>(plan.extras); }

/// Returns the fields of a record in the file, which have no gaps, under the names of the plan. The header has the
/// names of column_names() instead.
Schema ply_schema(const OutputPlan& plan) {
  Schema stored;
  for (const Field& field : plan.schema.fields) {
    stored.append(field.name, stored_type(field, ply_extras(plan) != nullptr), field.count);
  }
  return stored;
}

std::string ply_header_text(const OutputPlan& plan) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  if (plan.crs) {
    for (const std::string& line : crs_comments(*plan.crs)) header += line + "\n";
  }
  if (plan.las) header += las_comment(*plan.las) + "\n";
  std::span<const std::string> provenance = plan.provenance;
  if (const PlyExtras* extras = ply_extras(plan)) {
    for (const std::string& line : extras->lines) header += line + "\n";
    provenance = provenance_beyond(provenance, extras->provenance);
  }
  for (const std::string& line : provenance) header += "comment " + line + "\n";
  header += fmt::format("element vertex {}\n", plan.count);
  const auto names = column_names(plan.schema);
  std::size_t column = 0;
  for (const Field& field : ply_schema(plan).fields) {
    for (std::uint32_t c = 0; c < field.count; ++c) {
      header += fmt::format("property {} {}\n", ply_name_of(field.type), names[column++]);
    }
  }
  return header + "end_header\n";
}

class PlyWriter final : public RecordWriter {
 public:
  explicit PlyWriter(const OutputPlan& plan) : RecordWriter(plan, ply_header_text(plan), ply_schema(plan)) {
    for (const Field& field : plan.schema.fields) {
      if (field.is_plain() && is_wide(field.type) && stored_type(field, ply_extras(plan) != nullptr) == Type::f64) {
        narrowed_.push_back(field);
      }
    }
    if (std::string changed = changed_names(plan.path, "PLY", plan.schema, column_names(plan.schema)); !changed.empty())
      add_warning(std::move(changed));
  }

 private:
  void check(std::uint64_t row, std::span<const std::byte> records) override {
    const std::size_t stride = plan().schema.stride;
    for (std::size_t at = 0; !narrowed_.empty() && at < records.size(); at += stride)
      for (const Field& field : narrowed_)
        for (std::uint32_t c = 0; c < field.count; ++c)
          if (!is_exact_as_double(field, records.data() + at + field.offset + 8 * c)) refuse(field, row + at / stride);
  }

  static bool is_exact_as_double(const Field& field, const std::byte* at) {
    const auto exact = []<class T>(T value) {
      const auto wide = static_cast<double>(value);
      return wide < static_cast<double>(std::numeric_limits<T>::max()) && static_cast<T>(wide) == value;
    };
    std::uint64_t bits = 0;
    std::memcpy(&bits, at, sizeof bits);
    return field.type == Type::i64 ? exact(static_cast<std::int64_t>(bits)) : exact(bits);
  }

  [[noreturn]] void refuse(const Field& field, std::uint64_t row) const {
    throw RowError(row,
                   {plan().path.string() + ": row ",
                    fmt::format(": '{}' needs all of its 64 bits, which PLY cannot hold without loss; write a .las "
                                "file instead.",
                                field.name)});
  }

  std::vector<Field> narrowed_;
};

constexpr std::string_view kPlyExtensions[] = {".ply"};

bool is_ply(std::string_view head) {
  return head.starts_with("ply") && head.size() > 3 && std::string_view("\r\n\t ").find(head[3]) != head.npos;
}

}  // namespace

std::unique_ptr<Writer> create_ply_writer(const OutputPlan& plan) { return std::make_unique<PlyWriter>(plan); }

const Format kPlyFormat = {.name = "PLY",
                           .title = "PLY",
                           .details = "",
                           .reads = "ascii, binary little- and big-endian",
                           .writes = "binary little-endian",
                           .extensions = kPlyExtensions,
                           .is = is_ply,
                           .open = open_ply,
                           .create = create_ply_writer,
                           .holds_crs = true,
                           .holds_provenance = true,
                           .is_sequential = true};

}  // namespace pointsweep
