// SPDX-License-Identifier: MIT
/// NumPy arrays of points: .npy files, and .npz archives whose members are stored.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/npy/npy_format.h"
#include "pointsweep/formats/records/record_readers.h"

namespace pointsweep {
namespace {

constexpr std::string_view kLocalHeader("PK\3\4", 4), kDirectoryEntry("PK\1\2", 4), kDirectoryEnd("PK\5\6", 4),
    kDirectoryEnd64("PK\6\6", 4), kLocator64("PK\6\7", 4);
constexpr std::uint64_t kLocalBytes = 30, kEntryBytes = 46, kEndBytes = 22, kEnd64Bytes = 56, kLocatorBytes = 20;
constexpr std::uint64_t kLongestComment = 65535, kMostMembers = 4096;
constexpr std::uint32_t kIn64 = 0xffffffff;  ///< means that the value is in a zip64 record
constexpr std::string_view kArrayName = ".npy";

/// Returns a little-endian number of `size` bytes.
std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

struct NpzMember {
  std::string name;                  ///< without ".npy"
  std::uint64_t begin = 0, end = 0;  ///< range of its bytes in the file
};

class NpzDirectory {
 public:
  explicit NpzDirectory(const InputFile& file) : file_(file) {}

  std::vector<NpzMember> members() {
    find_directory();
    std::vector<NpzMember> members;
    for (std::uint64_t i = 0; i < entries_; ++i) take_entry(members);
    return members;
  }

 private:
  [[noreturn]] void fail_damaged() const {
    fail("{}: is a damaged or incomplete NPZ archive; get the whole file.", file_.path().string());
  }

  std::string bytes_at(std::uint64_t offset, std::uint64_t size) const {
    if (offset > file_.size() || size > file_.size() - offset) fail_damaged();
    std::string bytes(static_cast<std::size_t>(size), '\0');
    file_.read_at(offset, std::as_writable_bytes(std::span(bytes)));
    return bytes;
  }

  /// Finds the directory of the archive by the record at the end of the file.
  void find_directory() {
    const std::uint64_t window = std::min(file_.size(), kEndBytes + kLongestComment);
    const std::string tail = bytes_at(file_.size() - window, window);
    const std::size_t at = tail.rfind(kDirectoryEnd);
    if (at == tail.npos || tail.size() - at < kEndBytes) fail_damaged();
    entries_ = number_at(tail, at + 10, 2);
    next_ = number_at(tail, at + 16, 4);
    const std::uint64_t end = file_.size() - window + at;
    if (end >= kLocatorBytes) {
      const std::string locator = bytes_at(end - kLocatorBytes, kLocatorBytes);
      if (locator.starts_with(kLocator64)) {
        const std::string end64 = bytes_at(number_at(locator, 8, 8), kEnd64Bytes);
        if (!end64.starts_with(kDirectoryEnd64)) fail_damaged();
        entries_ = number_at(end64, 32, 8);
        next_ = number_at(end64, 48, 8);
      }
    }
    if (entries_ > kMostMembers) fail("{}: has more than {} members.", file_.path().string(), kMostMembers);
  }

  void take_entry(std::vector<NpzMember>& members) {
    const std::string entry = bytes_at(next_, kEntryBytes);
    if (!entry.starts_with(kDirectoryEntry)) fail_damaged();
    const std::uint64_t name_bytes = number_at(entry, 28, 2), extra_bytes = number_at(entry, 30, 2);
    NpzMember member{.name = bytes_at(next_ + kEntryBytes, name_bytes)};
    const std::string extra = bytes_at(next_ + kEntryBytes + name_bytes, extra_bytes);
    next_ += kEntryBytes + name_bytes + extra_bytes + number_at(entry, 32, 2);
    if (!member.name.ends_with(kArrayName)) return;
    if (number_at(entry, 10, 2) != 0)
      fail("{}: is compressed, and pointsweep reads stored archives; save it with numpy.savez, not savez_compressed.",
           file_.path().string());
    // Size, compressed size and offset. The extra bytes hold those that need 64 bits, in this order.
    std::array<std::uint64_t, 3> values{number_at(entry, 24, 4), number_at(entry, 20, 4), number_at(entry, 42, 4)};
    take_large(extra, values);
    const std::string local = bytes_at(values[2], kLocalBytes);
    if (!local.starts_with(kLocalHeader)) fail_damaged();
    member.begin = values[2] + kLocalBytes + number_at(local, 26, 2) + number_at(local, 28, 2);
    if (member.begin > file_.size() || values[0] > file_.size() - member.begin) fail_damaged();
    member.end = member.begin + values[0];
    member.name.resize(member.name.size() - kArrayName.size());
    members.push_back(std::move(member));
  }

  /// Replaces the values that are in the zip64 field (tag 1) of the extra bytes: size, compressed size, offset.
  static void take_large(std::string_view extra, std::array<std::uint64_t, 3>& values) {
    while (extra.size() >= 4) {
      const std::size_t size = std::min<std::size_t>(number_at(extra, 2, 2), extra.size() - 4);
      std::string_view field = extra.substr(4, size);
      if (number_at(extra, 0, 2) == 1) {
        for (std::uint64_t& value : values) {
          if (value != kIn64 || field.size() < 8) continue;
          value = number_at(field, 0, 8);
          field.remove_prefix(8);
        }
      }
      extra.remove_prefix(4 + size);
    }
  }

  const InputFile& file_;
  std::uint64_t entries_ = 0, next_ = 0;  ///< entries of the directory; byte of its next entry
};

/// Returns whether a file that begins with `head` is a zip archive whose first member is a NumPy array.
bool starts_as_npz(std::string_view head) {
  if (!head.starts_with(kLocalHeader) || head.size() < kLocalBytes) return false;
  return head.substr(kLocalBytes, static_cast<std::size_t>(number_at(head, 26, 2))).ends_with(kArrayName);
}

/// Returns the arrays in an archive of any size (zip64). Throws Error for a damaged archive and for compressed members.
std::vector<NpzMember> npz_members(const InputFile& file) { return NpzDirectory(file).members(); }

constexpr std::uint64_t kMostColumns = 65536;
constexpr std::uint64_t kRowsLookedAt = 100;

struct NpyArray {
  std::string name;  ///< name in an archive (.npz); empty for a .npy file
  NpyHeader header;

  /// Returns the number of values per row: the size of the last axis of a table, else 1.
  std::uint64_t columns() const { return is_table() ? header.shape.back() : 1; }
  std::uint64_t rows() const { return header.elements(is_table() ? 1 : 0); }
  bool is_table() const { return !header.is_structured && header.shape.size() >= 2; }
  bool can_be_positions() const { return header.is_structured || (is_table() && columns() >= 3); }
};

class NpyPointsReader final : public ColumnsReader {
 public:
  explicit NpyPointsReader(const std::filesystem::path& path) : file_(std::make_shared<const InputFile>(path)) {
    info_.path = path;
    info_.bytes = file_->size();
    read_arrays();
    const std::vector<const NpyArray*> positions = find_positions();
    info_.count = positions.front()->rows();
    for (const NpyArray* array : positions) add(*array);
    for (const NpyArray& array : arrays_)
      if (std::ranges::find(positions, &array) == positions.end()) add_attribute(array);
    position_fields(info_.schema, name());
    warn(*positions.front());
    has_columns(file_, std::move(columns_), std::move(big_endian_));
    if (has_default_names_) name_columns();
  }

 private:
  std::string name() const { return info_.path.string(); }

  void read_arrays() {
    std::string head(4, '\0');
    head.resize(file_->read_some(0, std::as_writable_bytes(std::span(head))));
    if (!head.starts_with("PK")) {
      arrays_.push_back({"", read_npy_header(*file_, 0, file_->size(), name())});
      info_.format = fmt::format("NumPy array of {}", arrays_[0].header.description);
      return;
    }
    for (NpzMember& member : npz_members(*file_)) {
      const std::string what = fmt::format("{}: {}.npy", name(), member.name);
      arrays_.push_back({std::move(member.name), read_npy_header(*file_, member.begin, member.end, what)});
    }
    info_.format = fmt::format("NPZ archive of {} NumPy array{}", arrays_.size(), arrays_.size() == 1 ? "" : "s");
  }

  /// Returns one array with x, y and z, or three arrays with one coordinate each.
  std::vector<const NpyArray*> find_positions() const {
    std::vector<const NpyArray*> axes, possible;
    for (const char* axis : {"x", "y", "z"})
      for (const NpyArray& array : arrays_)
        if (array.name == axis && array.columns() == 1 && !array.header.is_structured) axes.push_back(&array);
    if (axes.size() == 3 && axes[0]->rows() == axes[1]->rows() && axes[0]->rows() == axes[2]->rows()) return axes;
    for (const NpyArray& array : arrays_) {
      if (!array.can_be_positions()) continue;
      for (const char* known : {"xyz", "points", "position", "positions", "vertices", "coordinates"})
        if (array.name == known) return {&array};
      possible.push_back(&array);
    }
    if (possible.size() == 1) return possible;
    if (arrays_.size() == 1 && !arrays_[0].header.is_structured)
      fail("{}: its shape ({}) is not that of points, which have three columns or more.", name(),
           fmt::join(arrays_[0].header.shape, ", "));
    fail("{}: {} of its {} arrays could hold the points; call the one that does 'xyz' or 'points'.", name(),
         possible.empty() ? "none" : "several", arrays_.size());
  }

  void add(const NpyArray& array) {
    const std::size_t first = info_.schema.fields.size();
    const std::uint32_t begin = info_.schema.stride;
    if (array.columns() > kMostColumns) fail("{}: has more than {} columns.", name(), kMostColumns);
    if (array.header.is_structured)
      add_structured(array);
    else if (array.can_be_positions() && first == 0)
      add_table(array);
    else
      append_array(info_.schema, array.name, array.header.item.fields[0].type,
                   static_cast<std::uint32_t>(array.columns()));
    const std::vector<Field>& fields = info_.schema.fields;
    add_columns(array, begin);
    if (!array.header.is_structured && !array.header.big_endian.empty())
      big_endian_.insert(big_endian_.end(), fields.begin() + static_cast<std::ptrdiff_t>(first), fields.end());
  }

  /// Adds x, y, z and further columns of one array.
  void add_table(const NpyArray& array) {
    has_default_names_ = true;
    std::vector<std::string> names{"x", "y", "z"};
    while (names.size() < array.columns()) names.push_back(fmt::format("column_{}", names.size() + 1));
    for (std::string& column : names) info_.schema.append(std::move(column), array.header.item.fields[0].type);
  }

  void add_structured(const NpyArray& array) {
    Schema& schema = info_.schema;
    const std::uint32_t begin = schema.stride;
    for (const Field& field : array.header.item.fields) {
      schema.stride = begin + field.offset;
      const std::size_t first = append_array(schema, field.name, field.type, field.count);
      if (std::ranges::find(array.header.big_endian, field.offset, &Field::offset) != array.header.big_endian.end())
        big_endian_.insert(big_endian_.end(), schema.fields.begin() + static_cast<std::ptrdiff_t>(first),
                           schema.fields.end());
    }
    schema.stride = begin + array.header.item.stride;
  }

  void add_columns(const NpyArray& array, std::uint32_t offset) {
    const NpyHeader& header = array.header;
    const std::uint32_t item = header.item.stride, columns = static_cast<std::uint32_t>(array.columns());
    if (!header.fortran_order || header.shape.size() < 2 || columns == 1) {
      columns_.push_back({header.data, item * columns, offset});
      return;
    }
    if (header.shape.size() > 2)
      fail("{}: is in Fortran order and has {} axes; save it in C order.", name(), header.shape.size());
    for (std::uint32_t c = 0; c < columns; ++c)
      columns_.push_back({header.data + c * array.rows() * item, item, offset + c * item});
  }

  void add_attribute(const NpyArray& array) {
    if (array.rows() == info_.count && array.columns() > 0)
      add(array);
    else
      left_out_.push_back(array.name);
  }

  void warn(const NpyArray& positions) {
    const std::vector<std::uint64_t>& shape = positions.header.shape;
    if (shape.size() > (positions.is_table() ? 2 : 1))
      info_.warnings.push_back(
          fmt::format("{}: that its points are an array of {} axes is not kept in an output.", name(), shape.size()));
    if (!left_out_.empty())
      info_.warnings.push_back(
          fmt::format("{}: the array{} {} left out, since the points have another number of rows.", name(),
                      left_out_.size() == 1 ? "" : "s",
                      fmt::format("{} {}", fmt::join(left_out_, ", "), left_out_.size() == 1 ? "is" : "are")));
  }

  /// Gives the columns of an array the names of default_column_names(), as text without a header gets them.
  void name_columns() {
    std::vector<Field>& fields = info_.schema.fields;
    const std::size_t columns = columns_of_table();
    const std::size_t stride = info_.schema.stride;
    std::vector<std::byte> records(std::min(kRowsLookedAt, info_.count) * stride);
    read(0, records);
    std::vector<std::vector<double>> rows;
    for (std::size_t at = 0; at < records.size(); at += stride) {
      rows.emplace_back();
      for (std::size_t c = 0; c < columns; ++c) rows.back().push_back(value_of(fields[c], records.data() + at));
    }
    if (rows.empty()) rows.emplace_back(columns, 0.5);
    const std::vector<std::string> names = default_column_names(rows);
    for (std::size_t c = 0; c < columns; ++c) fields[c].name = names[c];
    rest();
  }
  std::size_t columns_of_table() const { return static_cast<std::size_t>(find_positions().front()->columns()); }

  std::shared_ptr<const InputFile> file_;
  std::vector<NpyArray> arrays_;
  std::vector<StoredColumn> columns_;
  std::vector<Field> big_endian_;
  std::vector<std::string> left_out_;
  bool has_default_names_ = false;  ///< true if the positions are an array whose columns have no names
};

constexpr std::string_view kNpzExtensions[] = {".npz"};

/// Returns whether a file that begins with `head` is a NumPy array or an archive of NumPy arrays.
bool starts_as_npy_points(std::string_view head) { return head.starts_with("\x93NUMPY") || starts_as_npz(head); }

}  // namespace

std::unique_ptr<Reader> open_npy_points(const std::filesystem::path& path) {
  return std::make_unique<NpyPointsReader>(path);
}

const Format kNpyPointsFormat = {
    .name = "NumPy array",
    .title = "NumPy points",
    .details = "#numpy",
    .reads = "`.npy` of three columns or more, or of a structured type; `.npz` that is stored",
    .writes = "no",
    .extensions = kNpzExtensions,
    .is = starts_as_npy_points,
    .open = open_npy_points};

}  // namespace pointsweep
