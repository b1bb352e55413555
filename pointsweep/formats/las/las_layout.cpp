// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_layout.h"

#include <algorithm>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/known_values.h"
#include "pointsweep/formats/las_scale.h"
#include "pointsweep/points/color_depth.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

bool same_encoding(const Field& a, const Field& b) {
  return a.type == b.type && a.count == b.count && a.bit_shift == b.bit_shift && a.bit_width == b.bit_width &&
         a.scale == b.scale && a.bias == b.bias;
}

/// Bytes of x, y and z, with which a record of LAS begins.
constexpr std::uint32_t kLasPositionBytes = 12;
constexpr double kFineStep = 0.001;  ///< in metres, less than the error of most scanners

/// Returns the bytes of the first three fields.
std::uint32_t position_bytes(const Schema& schema) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < 3; ++i) bytes += size_of(schema.fields[i].type);
  return static_cast<std::uint32_t>(bytes);
}

bool is_position_field(std::string_view name) { return name == "x" || name == "y" || name == "z"; }

/// Chooses the header and the records of a file, field by field.
class Builder {
 public:
  Builder(const OutputPlan& plan, LasPoints points)
      : plan_(plan), points_(points), parts_(parts_of(plan.extras)), input_(parts_.get()) {
    layout_.header = input_ != nullptr ? input_->header : new_las_header();
    if (input_ != nullptr) layout_.input = input_->file;
    layout_.from.stride = plan.schema.stride;
  }

  LasLayout build() {
    kept_ = input_ != nullptr && las_keeps_records(*input_, plan_.schema, plan_.layout) && !makes_fields_of_formats() &&
            !(points_ == LasPoints::nodes && has_arrays(*input_));
    layout_.points_moved = is_made("x");
    layout_.grid_is_stated = plan_.layout.scale || plan_.layout.offset;
    if (plan_.bounds && !plan_.bounds->empty()) layout_.fitting_scale = fitting_scale(*plan_.bounds);
    if (kept_) {
      keep_records();
    } else {
      convert_records();
    }
    layout_.header.record_length = static_cast<std::uint16_t>(layout_.to.stride);
    if (plan_.count > std::numeric_limits<std::uint32_t>::max()) upgrade_las_header(layout_.header, 4);
    if (plan_.layout.las_version) take_version(*plan_.layout.las_version);
    place_las_pieces(plan_, points_, input_, {std::move(vlr_), extended_, kept_}, layout_);
    return std::move(layout_);
  }

 private:
  /// Returns the LAS parts of an input; null for an input of another format.
  static std::shared_ptr<const LasParts> parts_of(const std::shared_ptr<const FormatExtras>& extras) {
    const LasExtras* const las = extras_as<LasExtras>(extras);
    return las != nullptr ? las->parts() : nullptr;
  }

  static bool has_arrays(const LasParts& input) {
    return std::ranges::any_of(input.schema.fields, [](const Field& field) { return field.count > 1; });
  }

  /// Adds a pair of fields to the layout: the output stores the values of `from` in `to`.
  void connect(Field from, Field to) {
    from.name = to.name = std::to_string(layout_.from.fields.size());
    layout_.from.fields.push_back(std::move(from));
    layout_.to.fields.push_back(std::move(to));
  }

  /// Notes the name of an attribute in extra bytes. Warns if LAS cuts the name, and if an earlier attribute with this
  /// name is renamed. Throws UsageError if two names are equal only because LAS cuts them.
  void name_extra(const Field& field, std::uint32_t component) {
    const std::string whole = field.count == 1 ? field.name : fmt::format("{}[{}]", field.name, component);
    const std::string stored = extra_bytes_name(field, component);
    const bool is_cut = whole.size() > kLasNameBytes;
    const auto [same, is_new] = extra_names_.try_emplace(in_lower_case(stored), whole);
    if (!is_new && (is_cut || same->second.size() > kLasNameBytes))
      fail_usage(
          "{}: '{}' and '{}' would both be '{}', since LAS keeps {} bytes of a name; leave one out by --keep, or write "
          "PLY.",
          plan_.path.string(), same->second, whole, stored, kLasNameBytes);
    if (!is_new)
      layout_.warnings.push_back(
          fmt::format("{}: '{}' and '{}' are one name in LAS, '{}'; that of the first gets '_input' at its end.",
                      plan_.path.string(), std::exchange(same->second, whole), whole, stored));
    if (is_cut)
      layout_.warnings.push_back(fmt::format("{}: '{}' is written as '{}', since LAS keeps {} bytes of a name.",
                                             plan_.path.string(), whole, stored, kLasNameBytes));
  }

  /// Adds `field` as extra bytes. The description of the extra bytes comes from the input; for a made attribute, the
  /// description is the meaning of the attribute.
  void append_extra(const Field& field) {
    Field stored = field;
    stored.type = unpacked_type(field);
    stored.bit_shift = stored.bit_width = 0;
    stored.offset = layout_.to.stride;
    const std::uint64_t end = layout_.to.stride + std::uint64_t{size_of(stored.type)} * field.count;
    if (end > std::numeric_limits<std::uint16_t>::max() || vlr_.size() + field.count > kMaxExtraBytes) {
      fail(
          "{}: '{}' does not fit, since LAS allows {} values beyond its own and 65535 bytes a point; write fewer "
          "attributes, or PLY.",
          plan_.path.string(), field.name, kMaxExtraBytes);
    }
    for (std::uint32_t c = 0; c < field.count; ++c) name_extra(field, c);
    if (const auto known = descriptor_of(stored)) {
      vlr_.append_again(*known);
    } else {
      vlr_.append(stored, description_of(field.name));
    }
    layout_.to.stride = static_cast<std::uint32_t>(end);
    connect(field, stored);
    extended_ = true;
  }

  /// Returns the descriptor of the attribute in one of the inputs; none for made attributes, and none if the records
  /// are kept, where the VLR has the descriptors of the input already.
  std::optional<std::span<const std::byte>> descriptor_of(const Field& field) const {
    if (kept_ || is_made(field.name)) return std::nullopt;
    if (input_ != nullptr)
      if (const auto found = find_extra_bytes(input_->extra_bytes, field)) return found;
    for (const auto& extras : plan_.other_extras) {
      const LasExtras* other = extras_as<LasExtras>(extras);
      if (other == nullptr) continue;
      if (const auto found = find_extra_bytes(other->extra_bytes, field)) return found;
    }
    return std::nullopt;
  }

  bool is_made(std::string_view field) const {
    return std::ranges::any_of(
        plan_.made, [&](const Attribute& a) { return std::ranges::find(a.fields, field) != a.fields.end(); });
  }

  std::string description_of(std::string_view field) const {
    for (const Attribute& attribute : plan_.made) {
      for (std::size_t c = 0; c < attribute.fields.size(); ++c) {
        if (attribute.fields[c] == field) return extra_bytes_description(attribute, c);
      }
    }
    return "";
  }

  /// Returns whether the run makes an attribute that the input lacks and for which another point format has a field.
  /// Such an attribute is not stored in extra bytes.
  bool makes_fields_of_formats() const {
    return std::ranges::any_of(las_names_in(plan_.schema),
                               [&](const std::string& name) { return !input_->schema.find(name); });
  }

  /// Keeps the records of the input, except for coordinates that are now real numbers, and adds the made fields.
  void keep_records() {
    const Schema& own = input_->schema;
    const LasHeader& header = layout_.header;
    choose_scale(position_fields(plan_.schema, plan_.path.string()));
    Schema described = las_point_schema(header.point_format, header.scale, header.offset);
    const Schema format = described;
    layout_.to.stride = own.stride;
    keep_bytes(format);
    vlr_ = ExtraBytesVlr(input_->extra_bytes);
    append_extra_bytes(input_->extra_bytes, own.stride, described);
    if (described.stride < own.stride) vlr_.append_undocumented(own.stride - described.stride);
    for (std::size_t i = own.fields.size(); i < plan_.schema.fields.size(); ++i) {
      const Field& made = plan_.schema.fields[i];
      const auto at = format.find(made.name);
      if (!at || made.count != 1) {
        append_extra(made);
      } else {
        connect(made, format.fields[*at]);
      }
    }
    watch_positions(format);
  }

  void keep_bytes(const Schema& format) {
    Field record{.name = "", .type = Type::u8, .count = layout_.to.stride};
    const auto is_on_grid = [&](std::size_t axis) {
      return same_encoding(plan_.schema.fields[axis], format.fields[axis]);
    };
    if (is_on_grid(0) && is_on_grid(1) && is_on_grid(2)) return connect(record, record);
    for (std::size_t axis = 0; axis < 3; ++axis) connect(plan_.schema.fields[axis], format.fields[axis]);
    Field rest = record;
    rest.offset = kLasPositionBytes;
    rest.count -= kLasPositionBytes;
    Field from = rest;
    from.offset = position_bytes(plan_.schema);
    connect(from, rest);
  }

  /// Finds the source of each coordinate: the last field of `layout_.from` that is stored at the offset of the
  /// coordinate. Sets positions_change if a source is not stored unchanged.
  void watch_positions(const Schema& format) {
    Field* const places[] = {&layout_.x, &layout_.y, &layout_.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Field& target = format.fields[axis];
      Field* const place = places[axis];
      *place = target;
      for (std::size_t i = 0; i < layout_.to.fields.size(); ++i) {
        const Field& to = layout_.to.fields[i];
        if (to.type != Type::i32 || to.offset != target.offset) continue;
        *place = layout_.from.fields[i];
        layout_.positions_change = layout_.positions_change || !same_encoding(*place, target);
      }
    }
  }

  void convert_records() {
    LasHeader& header = layout_.header;
    const Schema& schema = plan_.schema;
    const std::vector<ValueRange> ranges = value_ranges();
    const LasChoice choice = las_choice(plan_.layout, plan_.las != nullptr && plan_.values != nullptr);
    header.point_format = static_cast<std::uint8_t>(choose_las_point_format(schema, ranges, choice));
    choose_version();
    choose_scale(position_fields(schema, plan_.path.string()));
    const Schema format = las_point_schema(header.point_format, header.scale, header.offset);
    layout_.to.stride = format.stride;
    std::vector<bool> stored(schema.fields.size());
    std::vector<std::size_t> inexact;
    const Schema source = in_sixteen_bits(format);
    for (const Field& target : format.fields) {
      const auto at = schema.find(target.name);
      if (!at || schema.fields[*at].count != 1) {
        if (target.name == "return_number" || target.name == "number_of_returns")
          layout_.missing_returns |= std::byte{1} << target.bit_shift;
        continue;
      }
      connect(source.fields[*at], target);
      stored[*at] = true;
      if (!is_position_field(target.name) && !las_field_holds(target, schema.fields[*at], ranges[*at]))
        inexact.push_back(*at);
    }
    layout_.overlap_by_class = plan_.las && plan_.las->overlap_is_class_12 && !schema.find("overlap") &&
                               schema.find("classification") && header.point_format >= kFirstModernLasFormat;
    std::vector<std::string> without_field;
    for (std::size_t i = 0; i < schema.fields.size(); ++i) {
      if (stored[i]) continue;
      if (choice.is_stated() && is_las_name(schema.fields[i].name)) {
        if (!is_made(schema.fields[i].name) && ranges[i].within(0, 0))
          continue;  // readers take 0 for a field that is missing
        without_field.push_back(schema.fields[i].name);
      }
      append_extra(schema.fields[i]);
    }
    if (!without_field.empty())
      layout_.warnings.push_back(fmt::format("{}: point format {} has no field for {}; extra bytes hold the values.",
                                             plan_.path.string(), header.point_format, fmt::join(without_field, ", ")));
    for (const std::size_t i : inexact) append_exact_copy(schema.fields[i]);
    watch_positions(format);
  }

  /// Returns the schema of the records, with 8-bit colours read as the 16-bit colours of LAS.
  Schema in_sixteen_bits(const Schema& format) {
    const std::optional<Schema> scaled = with_wide_colors(plan_.schema);
    if (!scaled || !format.find("red")) return plan_.schema;
    layout_.warnings.push_back(
        fmt::format("{}: red, green and blue of 8 bits are written as 16 bits, times 257.", plan_.path.string()));
    return *scaled;
  }

  void append_exact_copy(Field exact) {
    // The values of made attributes are not known yet, so that the warning says "may".
    layout_.warnings.push_back(
        fmt::format("{}: {} of '{}' {} not fit the LAS field; it has them rounded and within its range, the "
                    "extra bytes '{}_{}' have them exactly.",
                    plan_.path.string(), is_made(exact.name) ? "values" : "some values", exact.name,
                    is_made(exact.name) ? "may" : "do", exact.name, name_of(exact.type)));
    exact.name = fmt::format("{}_{}", exact.name, name_of(exact.type));
    append_extra(exact);
  }

  /// Returns the range of values of each field: from known values for a field of the input, from the type for a made
  /// field.
  std::vector<ValueRange> value_ranges() const {
    std::vector<ValueRange> ranges;
    for (std::size_t i = 0; i < plan_.schema.fields.size(); ++i) {
      const Field& field = plan_.schema.fields[i];
      const bool known = plan_.values != nullptr && i < plan_.values->ranges.size() && !is_made(field.name);
      ranges.push_back(known ? plan_.values->ranges[i] : range_of_type(field));
    }
    return ranges;
  }

  /// Chooses the oldest version that has the point format and is not older than any LAS input. Sets the bit of the
  /// global encoding that states the kind of GPS time of the inputs.
  void choose_version() {
    LasHeader& header = layout_.header;
    int minor = las_minor_of(header.point_format);
    for (const auto& extras : plan_.other_extras) {
      if (const LasExtras* other = extras_as<LasExtras>(extras)) minor = std::max<int>(minor, other->minor);
    }
    upgrade_las_header(header, minor);
    if (!plan_.las || !plan_.las->has_time) return;
    header.global_encoding = static_cast<std::uint16_t>((header.global_encoding & ~kLasStandardTimeBit) |
                                                        (plan_.las->standard_time ? kLasStandardTimeBit : 0));
  }

  /// Gives the header the version that the user states.
  void take_version(int minor) {
    LasHeader& header = layout_.header;
    const int least = plan_.count > std::numeric_limits<std::uint32_t>::max() ? 4 : las_minor_of(header.point_format);
    const bool has_hierarchy = input_ != nullptr && input_->evlrs.copc_hierarchy;  // which the output does not keep
    if (minor < least)
      fail_usage("{}: LAS 1.{} has no {}, which needs LAS 1.{}; state that version, or another point format.",
                 plan_.path.string(), minor,
                 least > las_minor_of(header.point_format) ? "more than 4294967295 points"
                                                           : fmt::format("point format {}", header.point_format),
                 least);
    if (minor < header.minor && (header.evlr_count > (has_hierarchy ? 1u : 0u) || header.waveform_start > 0))
      fail_usage("{}: LAS 1.{} has no place for the extended VLRs or waveforms of the input; state LAS 1.{}.",
                 plan_.path.string(), minor, header.minor);
    if (minor < 2 && (header.global_encoding & kLasStandardTimeBit) != 0 && las_has_time(header.point_format))
      fail_usage(
          "{}: LAS 1.{} knows only GPS time of the week, but the input has adjusted standard GPS time; state LAS "
          "1.2 or later, or point format 0.",
          plan_.path.string(), minor);
    set_las_version(header, minor);
  }

  /// Returns scales of the axes at which 32 bits reach all points, from the stated offset if there is one.
  Vec3 fitting_scale(const Box& bounds) const {
    const std::optional<Anchor>& offset = plan_.layout.offset;
    return offset && offset->at ? las_scale_from(*offset->at, bounds) : las_quantization(bounds).scale;
  }

  /// Sets the grid that the user states. If the user states only a scale or only an offset, `own`, the grid of the
  /// incoming coordinates, completes the statement; if they have no grid, the bounds do. An offset that is not stated
  /// moves where 32 bits do not reach the bounds.
  void take_stated_grid(const std::optional<LasQuantization>& own) {
    const auto& [scale, offset, format, version, decimals] = plan_.layout;
    LasQuantization grid = own.value_or(LasQuantization{{1, 1, 1}, {}});
    if (scale)
      grid.scale = *scale;
    else if (!own && layout_.fitting_scale)
      grid.scale = *layout_.fitting_scale;
    if (offset && offset->at)
      grid.offset = *offset->at;
    else if (plan_.bounds)
      grid = offset ? las_grid_in_the_middle(grid, *plan_.bounds) : las_grid_for_moved(grid, *plan_.bounds);
    set_grid(grid);
  }

  /// Chooses scale and offset. A stated grid has priority. LAS integers keep their grid. Real coordinates get the grid
  /// of the inputs if las_values() has found one, else the finest grid that 32 bits allow; without known bounds they
  /// get the grid in the header of the LAS input.
  void choose_scale(const PositionFields& p) {
    LasHeader& header = layout_.header;
    if (layout_.grid_is_stated) {
      take_stated_grid(las_keeps_scale(p) ? std::optional(grid_of(p)) : has_grid() ? plan_.values->grid : std::nullopt);
    } else if (las_keeps_scale(p)) {
      set_grid(grid_of(p));
    } else if (plan_.bounds && has_grid()) {
      const LasQuantization& grid = *plan_.values->grid;
      layout_.keeps_scale = true;
      set_grid(layout_.points_moved ? las_grid_for_moved(grid, *plan_.bounds) : las_grid_within(grid, *plan_.bounds));
      for (int axis = 0; axis < 3; ++axis)
        layout_.grid_is_coarse |= header.scale[axis] > grid.scale[axis] && !plan_.values->rounds;
      if (plan_.values->rounds)
        layout_.warnings.push_back(fmt::format(
            "{}: the scales and offsets of the inputs have no common grid that reaches all points; coordinates are "
            "rounded to steps of {} {} {}.",
            plan_.path.string(), header.scale.x, header.scale.y, header.scale.z));
    } else if (plan_.bounds) {
      set_grid(las_quantization(*plan_.bounds));
      const Vec3& scale = header.scale;
      layout_.grid_is_coarse = std::max({scale.x, scale.y, scale.z}) > kFineStep;
    } else if (input_ == nullptr && plan_.count != 0) {
      fail(
          "{}: LAS stores coordinates as integers and needs their bounds before the first point; give the bounds, or "
          "write PLY.",
          plan_.path.string());
    }
  }

  bool has_grid() const {
    return plan_.values && plan_.values->grid && !(plan_.values->by_decimals && layout_.points_moved);
  }

  void set_grid(const LasQuantization& grid) {
    layout_.header.scale = grid.scale;
    layout_.header.offset = grid.offset;
  }

  const OutputPlan& plan_;
  LasPoints points_;
  const std::shared_ptr<const LasParts> parts_;
  const LasParts* const input_;  ///< LAS parts of the first input, owned by parts_; null unless that input is LAS
  LasLayout layout_;
  ExtraBytesVlr vlr_;
  /// The name of each attribute in extra bytes, by its stored name in lower case.
  std::map<std::string, std::string> extra_names_;
  bool kept_ = false;      ///< records begin with the records of the input
  bool extended_ = false;  ///< vlr_ must be written
};

}  // namespace

std::uint64_t LasLayout::points_end(std::uint64_t count) const {
  return header.offset_to_points + count * header.record_length;
}

bool las_keeps_scale(const PositionFields& p) {
  const auto fits = [](const Field& f) {
    return f.bit_width == 0 && size_of(f.type) <= 4 && f.type != Type::u32 && f.type != Type::f32;
  };
  return fits(p.x) && fits(p.y) && fits(p.z);
}

bool las_begins_with_records_of(const LasParts& input, const Schema& schema) {
  const std::vector<Field>& own = input.schema.fields;
  const std::vector<Field>& all = schema.fields;
  if (all.size() < own.size()) return false;
  const std::uint32_t longer = position_bytes(schema) - kLasPositionBytes;
  if (schema.stride < input.schema.stride + longer) return false;
  for (std::size_t i = 0; i < own.size(); ++i) {
    Field field = all[i];
    if (i < 3) {
      if (field.offset != i * size_of(field.type) || field.bit_width != 0) return false;
      field = {
          .name = field.name, .type = Type::i32, .offset = own[i].offset, .scale = own[i].scale, .bias = own[i].bias};
    } else {
      field.offset -= longer;
    }
    if (field != own[i]) return false;
  }
  return std::all_of(all.begin() + std::ssize(own), all.end(),
                     [&](const Field& f) { return f.offset >= input.schema.stride + longer; });
}

bool las_keeps_records(const LasParts& input, const Schema& schema, const FileLayout& layout) {
  return las_begins_with_records_of(input, schema) &&
         layout.point_format.value_or(input.header.point_format) == input.header.point_format;
}

LasChoice las_choice(const FileLayout& layout, bool from_las) {
  const int minor = layout.las_version.value_or(4);
  return {.format = layout.point_format, .legacy = from_las || minor < 4, .most_minor = minor};
}

LasLayout lay_out_las(const OutputPlan& plan, LasPoints points) { return Builder(plan, points).build(); }

}  // namespace pointsweep
