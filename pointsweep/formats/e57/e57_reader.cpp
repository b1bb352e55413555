// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/fail.h"
#include "pointsweep/formats/crs.h"
#include "pointsweep/formats/e57/e57_format.h"
#include "pointsweep/formats/provenance.h"
#include "pointsweep/points/with_type.h"

namespace pointsweep {
namespace {

constexpr std::size_t kPointsAtOnce = 4096;

/// Returns the library's name for an attribute of E57. Unknown names are returned unchanged, and so are names of the
/// Cartesian coordinates, which a scan with spherical coordinates may have as attributes.
std::string name_of(const std::string& e57) {
  const auto known = std::find_if(std::begin(kE57Names) + kE57Coordinates, std::end(kE57Names),
                                  [&](const E57Name& name) { return name.theirs == e57; });
  return known == std::end(kE57Names) ? e57 : std::string(known->ours);
}

constexpr std::array<std::string_view, 3> kCartesian{"cartesianX", "cartesianY", "cartesianZ"},
    kSpherical{"sphericalRange", "sphericalAzimuth", "sphericalElevation"};

std::optional<std::size_t> find(const E57Scan& scan, std::string_view name) {
  const auto found = std::ranges::find(scan.attributes, name, &E57Attribute::name);
  if (found == scan.attributes.end()) return std::nullopt;
  return static_cast<std::size_t>(found - scan.attributes.begin());
}

/// Returns the smallest integer type for values from `least` to `most`.
Type integer_type(std::int64_t least, std::int64_t most) {
  const auto holds = [&]<class T>(T) {
    using Limits = std::numeric_limits<T>;
    return std::in_range<T>(least) && std::in_range<T>(most) && Limits::is_integer;
  };
  if (least >= 0) {
    if (holds(std::uint8_t{})) return Type::u8;
    if (holds(std::uint16_t{})) return Type::u16;
    if (holds(std::uint32_t{})) return Type::u32;
  }
  if (holds(std::int8_t{})) return Type::i8;
  if (holds(std::int16_t{})) return Type::i16;
  if (holds(std::int32_t{})) return Type::i32;
  return Type::i64;
}

/// An attribute of one or more scans, which becomes one field.
struct CommonAttribute {
  std::string name;
  bool single = true, integer = true;
  std::int64_t least = std::numeric_limits<std::int64_t>::max(), most = std::numeric_limits<std::int64_t>::min();

  void include(const E57Attribute& a) {
    single = single && a.kind == E57Attribute::Kind::single;
    integer = integer && a.kind == E57Attribute::Kind::integer;
    least = std::min(least, a.least);
    most = std::max(most, a.most);
  }
  Type type() const { return integer ? integer_type(least, most) : single ? Type::f32 : Type::f64; }
};

class E57Reader : public Reader {
 public:
  explicit E57Reader(const std::filesystem::path& path) : file_(path) {
    info_.path = path;
    info_.format = fmt::format("E57, {} scan{}", file_.scans().size(), file_.scans().size() == 1 ? "" : "s");
    info_.bytes = file_.file().size();
    // The memory of a packet and its values, estimated from the peak memory of runs.
    constexpr std::uint64_t kDecoderBytes = 3 << 20;
    info_.decoder_bytes = kDecoderBytes;
    info_.decode_once = true;
    make_schema();
    for (const E57Scan& scan : file_.scans()) {
      first_row_.push_back(info_.count);
      info_.count += scan.points;
      columns_.push_back(columns_of(scan));
    }
    if (!file_.coordinate_system().empty()) {
      Crs crs = crs_of_wkt(file_.coordinate_system());
      if (crs.kind != CrsKind::unknown || !crs.name.empty()) info_.crs = std::move(crs);
    }
    for (const E57Scan& scan : file_.scans()) add_provenance(info_.provenance, provenance_in(scan.description));
    if (file_.images() != 0)
      info_.warnings.push_back(fmt::format("{}: its {} image{} left out.", path.string(), file_.images(),
                                           file_.images() == 1 ? " is" : "s are"));
  }

  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    const std::size_t rows = rows_for(row, records);
    for (std::size_t done = 0; done < rows;) {
      stop_if_cancelled();
      const std::size_t scan = scan_of(row + done);
      const std::uint64_t in_scan = row + done - first_row_[scan];
      const std::size_t n = static_cast<std::size_t>(
          std::min<std::uint64_t>({rows - done, file_.scans()[scan].points - in_scan, std::uint64_t{kPointsAtOnce}}));
      go_to(scan, in_scan);
      decode(scan, n);
      fill(scan, n, records.data() + done * info_.schema.stride);
      done += n;
    }
    return rows;
  }

  void rest() override { points_.reset(); }

 private:
  /// An attribute, and the field of the record that gets its values.
  struct Column {
    std::size_t attribute;
    Field field;
  };
  /// The columns of one scan.
  struct Columns {
    std::array<std::size_t, 3> position{};  ///< indices of the attributes x, y, z, or range, azimuth, elevation
    bool spherical = false;
    std::optional<std::size_t> invalid;
    std::vector<Column> others;
  };

  void make_schema() {
    for (const char* axis : {"x", "y", "z"}) info_.schema.append(axis, Type::f64);
    if (!has_scan_numbers()) scan_ = info_.schema.append("scan", file_.scans().size() <= 65536 ? Type::u16 : Type::u32);
    std::vector<CommonAttribute> all;
    for (const E57Scan& scan : file_.scans()) {
      for (const E57Attribute& a : scan.attributes) {
        if (is_position(scan, a.name)) continue;
        auto at = std::ranges::find(all, name_of(a.name), &CommonAttribute::name);
        if (at == all.end()) at = all.insert(at, {.name = name_of(a.name)});
        at->include(a);
      }
    }
    for (const CommonAttribute& a : all) info_.schema.append(a.name, a.type());
    for (const char* name : {"nx", "ny", "nz"})
      if (const auto at = info_.schema.find(name)) normal_.push_back(info_.schema.fields[*at]);
  }

  /// Returns whether the file has one scan with an attribute "scan", like a file that was merged from several scans.
  bool has_scan_numbers() const { return file_.scans().size() == 1 && find(file_.scans().front(), "scan"); }

  static bool is_cartesian(const E57Scan& scan) {
    return std::ranges::all_of(kCartesian, [&](std::string_view name) { return find(scan, name).has_value(); });
  }
  static bool is_position(const E57Scan& scan, std::string_view name) {
    const auto& position = is_cartesian(scan) ? kCartesian : kSpherical;
    return std::ranges::find(position, name) != position.end();
  }

  Columns columns_of(const E57Scan& scan) const {
    Columns columns;
    columns.spherical = !is_cartesian(scan);
    for (std::size_t axis = 0; axis < 3 && scan.points > 0; ++axis) {
      const auto found = find(scan, (columns.spherical ? kSpherical : kCartesian)[axis]);
      if (!found)
        fail("{}: scan {} has neither Cartesian nor spherical coordinates.", info_.path.string(), columns_.size() + 1);
      columns.position[axis] = *found;
    }
    columns.invalid = find(scan, columns.spherical ? "sphericalInvalidState" : "cartesianInvalidState");
    for (std::size_t a = 0; a < scan.attributes.size(); ++a) {
      if (is_position(scan, scan.attributes[a].name)) continue;
      const auto at = std::ranges::find(info_.schema.fields, name_of(scan.attributes[a].name), &Field::name);
      columns.others.push_back({a, *at});
    }
    return columns;
  }

  /// Returns the scan that has row `row`: the last scan that begins at or before `row`, since scans may have no points.
  std::size_t scan_of(std::uint64_t row) const {
    return static_cast<std::size_t>(std::ranges::upper_bound(first_row_, row) - first_row_.begin()) - 1;
  }

  void go_to(std::size_t scan, std::uint64_t row) {
    if (!points_ || points_->scan() != scan || points_->next() > row)
      points_ = std::make_unique<E57File::Points>(file_, scan);
    while (points_->next() < row) {
      stop_if_cancelled();
      decode(scan, static_cast<std::size_t>(std::min<std::uint64_t>(kPointsAtOnce, row - points_->next())));
    }
  }

  void decode(std::size_t scan, std::size_t points) {
    values_.resize(points * file_.scans()[scan].attributes.size());
    points_->read(values_);
  }

  void fill(std::size_t number, std::size_t points, std::byte* record) const {
    const E57Scan& scan = file_.scans()[number];
    const Columns& columns = columns_[number];
    const std::size_t width = scan.attributes.size();
    for (std::size_t i = 0; i < points; ++i, record += info_.schema.stride) {
      std::memset(record, 0, info_.schema.stride);
      const std::uint64_t* values = values_.data() + i * width;
      const Vec3 position = position_of(scan, columns, values);
      std::memcpy(record, &position, sizeof position);
      if (scan_) set_value(info_.schema.fields[*scan_], record, static_cast<double>(number));
      for (const Column& column : columns.others)
        store(scan.attributes[column.attribute], values[column.attribute], column.field, record);
      if (scan.has_pose) rotate_normal(scan, record);
    }
  }

  static Vec3 position_of(const E57Scan& scan, const Columns& columns, const std::uint64_t* values) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (columns.invalid && values[*columns.invalid] != 0) return {kNone, kNone, kNone};
    const auto value = [&](std::size_t axis) {
      const std::size_t a = columns.position[axis];
      return scan.attributes[a].value(values[a]);
    };
    Vec3 p{value(0), value(1), value(2)};
    if (columns.spherical) {
      const double range = p.x, azimuth = p.y, elevation = p.z;
      p = {range * std::cos(elevation) * std::cos(azimuth), range * std::cos(elevation) * std::sin(azimuth),
           range * std::sin(elevation)};
    }
    if (!scan.has_pose) return p;
    const Vec3 turned = rotated(scan, p);
    return {turned.x + scan.translation[0], turned.y + scan.translation[1], turned.z + scan.translation[2]};
  }

  /// Returns q p q* for the unit quaternion q, the rotation of the scan.
  static Vec3 rotated(const E57Scan& scan, const Vec3& p) {
    const auto [w, x, y, z] = scan.rotation;
    return {(w * w + x * x - y * y - z * z) * p.x + 2 * (x * y - w * z) * p.y + 2 * (x * z + w * y) * p.z,
            2 * (x * y + w * z) * p.x + (w * w - x * x + y * y - z * z) * p.y + 2 * (y * z - w * x) * p.z,
            2 * (x * z - w * y) * p.x + 2 * (y * z + w * x) * p.y + (w * w - x * x - y * y + z * z) * p.z};
  }

  static void store(const E57Attribute& attribute, std::uint64_t stored, const Field& field, std::byte* record) {
    const bool whole = attribute.kind == E57Attribute::Kind::integer;
    with_type(field.type, [&]<class T>() {
      const T value =
          whole ? static_cast<T>(static_cast<std::int64_t>(stored)) : static_cast<T>(attribute.value(stored));
      std::memcpy(record + field.offset, &value, sizeof value);
    });
  }

  void rotate_normal(const E57Scan& scan, std::byte* record) const {
    if (normal_.size() != 3) return;
    const Vec3 n =
        rotated(scan, {value_of(normal_[0], record), value_of(normal_[1], record), value_of(normal_[2], record)});
    set_value(normal_[0], record, n.x);
    set_value(normal_[1], record, n.y);
    set_value(normal_[2], record, n.z);
  }

  E57File file_;
  std::vector<std::uint64_t> first_row_;
  std::vector<Columns> columns_;
  std::optional<std::size_t> scan_;  ///< index of the field "scan" of make_schema(); none if has_scan_numbers()
  std::vector<Field> normal_;        ///< nx, ny, nz, if the file has them
  std::unique_ptr<E57File::Points> points_;
  std::vector<std::uint64_t> values_;
};

}  // namespace

std::unique_ptr<Reader> open_e57(const std::filesystem::path& path) { return std::make_unique<E57Reader>(path); }

}  // namespace pointsweep
