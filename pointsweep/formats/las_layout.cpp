// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las_layout.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "pointsweep/error.h"
#include "pointsweep/formats/las_crs.h"
#include "pointsweep/formats/las_extra_bytes.h"
#include "pointsweep/formats/las_point_formats.h"
#include "pointsweep/formats/las_scale.h"

namespace pointsweep {
namespace {

bool same_encoding(const Field& a, const Field& b) {
  return a.type == b.type && a.count == b.count && a.bit_shift == b.bit_shift && a.bit_width == b.bit_width &&
         a.scale == b.scale && a.bias == b.bias;
}

/// Smallest and largest value of an integer field, or nothing for a real one.
std::optional<std::pair<double, double>> integer_range(const Field& field) {
  if (!field.is_plain() && field.bit_width == 0) return std::nullopt;
  if (field.bit_width != 0) return std::pair{0.0, static_cast<double>((1u << field.bit_width) - 1)};
  switch (field.type) {
    case Type::i8:
      return std::pair{-128.0, 127.0};
    case Type::u8:
      return std::pair{0.0, 255.0};
    case Type::i16:
      return std::pair{-32768.0, 32767.0};
    case Type::u16:
      return std::pair{0.0, 65535.0};
    case Type::i32:
      return std::pair{-2147483648.0, 2147483647.0};
    case Type::u32:
      return std::pair{0.0, 4294967295.0};
    default:
      return std::nullopt;
  }
}

/// True if `to` can hold every value that `from` can.
bool holds_exactly(const Field& from, const Field& to) {
  if (same_encoding(from, to)) return true;
  const auto source = integer_range(from), target = integer_range(to);
  if (to.type == Type::f64 && to.is_plain()) return source || (from.type == Type::f32 && from.is_plain());
  return source && target && source->first >= target->first && source->second <= target->second;
}

/// Collects the layout field by field.
class Builder {
 public:
  explicit Builder(const OutputPlan& plan) : plan_(plan), input_(dynamic_cast<const LasExtras*>(plan.extras.get())) {
    layout_.header = input_ != nullptr ? input_->header : new_las_header();
    if (input_ != nullptr) layout_.input = input_->file;
    layout_.from.stride = plan.schema.stride;
  }

  LasLayout build() {
    kept_ = begins_with_input_records();
    if (kept_) {
      keep_records();
    } else {
      convert_records();
    }
    layout_.header.record_length = static_cast<std::uint16_t>(layout_.to.stride);
    if (plan_.count > std::numeric_limits<std::uint32_t>::max()) upgrade_to_las_1_4(layout_.header);
    place_pieces();
    return std::move(layout_);
  }

 private:
  bool begins_with_input_records() const {
    if (input_ == nullptr || plan_.schema.stride < input_->schema.stride) return false;
    const std::vector<Field>& own = input_->schema.fields;
    const std::vector<Field>& all = plan_.schema.fields;
    return own.size() <= all.size() && std::equal(own.begin(), own.end(), all.begin()) &&
           std::all_of(all.begin() + std::ssize(own), all.end(),
                       [&](const Field& f) { return f.offset >= input_->schema.stride; });
  }

  /// Values of `from` go to `to`.
  void connect(Field from, Field to) {
    from.name = to.name = std::to_string(layout_.from.fields.size());
    layout_.from.fields.push_back(std::move(from));
    layout_.to.fields.push_back(std::move(to));
  }

  void append_extra(const Field& field) {
    Field stored = field;
    stored.bit_shift = stored.bit_width = 0;
    stored.offset = layout_.to.stride;
    const std::uint64_t end = layout_.to.stride + std::uint64_t{size_of(field.type)} * field.count;
    if (end > std::numeric_limits<std::uint16_t>::max() || vlr_.size() + field.count > kMaxExtraBytes) {
      fail(
          "{}: '{}' does not fit, since LAS allows {} values beyond its own and 65535 bytes a point; write fewer "
          "attributes, or PLY.",
          plan_.path.string(), field.name, kMaxExtraBytes);
    }
    vlr_.append(stored);
    layout_.to.stride = static_cast<std::uint32_t>(end);
    connect(field, stored);
    extended_ = true;
  }

  /// The records of the input as they are, then what was made.
  void keep_records() {
    const Schema& own = input_->schema;
    const LasHeader& header = layout_.header;
    Field record;
    record.type = Type::u8;
    record.count = own.stride;
    layout_.to.stride = own.stride;
    connect(record, record);
    vlr_ = ExtraBytesVlr(input_->extra_bytes);
    Schema described = las_point_schema(header.point_format, header.scale, header.offset);
    const Schema format = described;
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

  /// The last field that goes to x, y or z is what has to fit.
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
    upgrade_to_las_1_4(header);
    const Schema& schema = plan_.schema;
    const bool color = schema.find("red") && schema.find("green") && schema.find("blue");
    header.point_format = schema.find("nir") ? 8 : color ? 7 : 6;
    choose_scale(position_fields(schema, plan_.path.string()));
    const Schema format = las_point_schema(header.point_format, header.scale, header.offset);
    layout_.to.stride = format.stride;
    std::vector<bool> stored(schema.fields.size());
    std::vector<std::size_t> inexact;
    for (const Field& target : format.fields) {
      const auto at = schema.find(target.name);
      if (!at || schema.fields[*at].count != 1) continue;
      connect(schema.fields[*at], target);
      stored[*at] = true;
      const bool position = target.name == "x" || target.name == "y" || target.name == "z";
      if (!position && !holds_exactly(schema.fields[*at], target)) inexact.push_back(*at);
    }
    layout_.returns_missing = !schema.find("return_number");
    for (std::size_t i = 0; i < schema.fields.size(); ++i) {
      if (!stored[i]) append_extra(schema.fields[i]);
    }
    for (const std::size_t i : inexact) {
      Field exact = schema.fields[i];
      exact.name = fmt::format("{}_{}", exact.name, name_of(exact.type));
      append_extra(exact);
    }
    watch_positions(format);
  }

  /// LAS integers keep their scale; so does a LAS input whose coordinates changed their type, unless bounds are known.
  void choose_scale(const PositionFields& p) {
    LasHeader& header = layout_.header;
    if (las_keeps_scale(p)) {
      header.scale = {p.x.scale, p.y.scale, p.z.scale};
      header.offset = {p.x.bias, p.y.bias, p.z.bias};
    } else if (plan_.bounds) {
      const LasQuantization q = las_quantization(*plan_.bounds);
      header.scale = q.scale;
      header.offset = q.offset;
    } else if (input_ == nullptr && plan_.count != 0) {
      fail(
          "{}: LAS stores coordinates as integers and needs their bounds before the first point; give the bounds, or "
          "write PLY.",
          plan_.path.string());
    }
  }

  void place_pieces() {
    LasHeader& header = layout_.header;
    bool replaced = false;
    if (input_ != nullptr) {
      const LasVlrChain& vlrs = input_->vlrs;
      const bool stale = vlrs.extra_bytes && (extended_ || !kept_);
      layout_.before = {vlrs.start, vlrs.end};
      layout_.after = {vlrs.end, input_->header.offset_to_points};
      layout_.tail = {input_->points_end, input_->file->size()};
      if (stale) {
        layout_.before.end = vlrs.extra_bytes->start;
        layout_.after.begin = vlrs.extra_bytes->end();
        replaced = true;
      }
    }
    std::uint32_t added = 0;
    if (extended_) {
      add_extra_bytes_vlr();
      ++added;
    }
    added += add_crs_vlrs();
    if (added != 0 || replaced) {
      header.vlr_count = (input_ != nullptr ? input_->vlrs.count : 0) + added - (replaced ? 1 : 0);
    }
    const std::uint64_t points =
        header.header_size + layout_.before.size() + layout_.added_vlrs.size() + layout_.after.size();
    if (points > std::numeric_limits<std::uint32_t>::max()) {
      fail("{}: the header and VLRs would take {} bytes, and LAS allows 4294967295; write PLY.", plan_.path.string(),
           points);
    }
    header.offset_to_points = static_cast<std::uint32_t>(points);
    if (input_ == nullptr) return;
    move_reference(header.evlr_start);
    move_reference(header.waveform_start);
  }

  /// Byte offsets of the input that point behind its points.
  void move_reference(std::uint64_t& place) const {
    if (place >= input_->points_end) place = place - input_->points_end + layout_.points_end(plan_.count);
  }

  void add_extra_bytes_vlr() {
    std::vector<std::byte> vlr = las_vlr(kLasSpecUser, kExtraBytesRecord, "Extra bytes", vlr_.bytes());
    if (input_ != nullptr && input_->vlrs.extra_bytes) {  // under the header that the file had
      input_->file->read_at(input_->vlrs.extra_bytes->start, std::span(vlr).first(kLasVlrHeader));
      const auto length = static_cast<std::uint16_t>(vlr_.bytes().size());
      std::memcpy(vlr.data() + 20, &length, sizeof length);
    }
    add_vlrs(vlr);
  }

  /// Adds the coordinate reference system if the LAS input, whose VLRs are kept, has none. Returns how many VLRs.
  std::uint32_t add_crs_vlrs() {
    if (!plan_.crs || (input_ != nullptr && input_->crs)) return 0;
    const LasCrsVlrs vlrs = las_crs_vlrs(*plan_.crs);
    add_vlrs(vlrs.bytes);
    return vlrs.count;
  }

  void add_vlrs(const std::vector<std::byte>& vlrs) {
    layout_.added_vlrs.insert(layout_.added_vlrs.end(), vlrs.begin(), vlrs.end());
  }

  const OutputPlan& plan_;
  const LasExtras* input_;
  LasLayout layout_;
  ExtraBytesVlr vlr_;
  bool kept_ = false;      ///< records begin with those of the input
  bool extended_ = false;  ///< vlr_ has to be written
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

LasLayout lay_out_las(const OutputPlan& plan) { return Builder(plan).build(); }

}  // namespace pointsweep
