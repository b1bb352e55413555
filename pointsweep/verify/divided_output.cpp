// SPDX-License-Identifier: MIT
/// A check of the division into tiles with buffers, or by the values of an attribute, against its definition in run.h,
/// without the code by which a run divides its output.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/number_from.h"
#include "pointsweep/points/schema.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/verify/rows/field_pair.h"
#include "pointsweep/verify/values/kept_rows.h"
#include "pointsweep/verify/verify.h"

namespace pointsweep {
namespace {

/// A part of a divided output: the two numbers of a tile, or the value of the dividing attribute and 0.
using Part = std::array<double, 2>;

/// The texts before and after the name of a part in the name of a file.
using Surrounding = std::pair<std::string, std::string>;

bool is_number(std::string_view word, double value) {
  const auto number = number_from<double>(word);
  return number && std::abs(*number - value) <= 1e-9 * std::max(1.0, std::abs(value));
}

/// Calls use(end) for each `end` for which the characters [begin, end) of `name` are a number equal to `value`.
template <class Use>
void for_each_end(std::string_view name, std::size_t begin, double value, Use use) {
  for (std::size_t end = begin + 1; end <= name.size(); ++end)
    if (is_number(name.substr(begin, end - begin), value)) use(end);
}

/// Returns the texts before and after each occurrence of a part's name in the file name `name`. The name of a part is
/// `numbers`, joined by '_', or "unplaced" without numbers.
std::set<Surrounding> surroundings_in(std::string_view name, std::span<const double> numbers) {
  constexpr std::string_view kUnplaced = "unplaced";
  std::set<Surrounding> all;
  for (std::size_t begin = 0; begin < name.size(); ++begin) {
    const auto add = [&](std::size_t end) { all.emplace(name.substr(0, begin), name.substr(end)); };
    if (numbers.empty()) {
      if (name.substr(begin).starts_with(kUnplaced)) add(begin + kUnplaced.size());
      continue;
    }
    for_each_end(name, begin, numbers[0], [&](std::size_t end) {
      if (numbers.size() == 1) return add(end);
      if (end < name.size() && name[end] == '_') for_each_end(name, end + 1, numbers[1], add);
    });
  }
  return all;
}

/// The hashes of the position and of the values of a point in a buffer.
struct BufferPoint {
  std::uint64_t place;
  std::uint64_t values;  ///< hash of all values of the point except `buffer`
};

/// Sums of the hashes of all points of a buffer, which do not depend on the order of the points. Equal buffers have
/// equal sums.
struct BufferSum {
  MultisetSum places, values;

  void add(const BufferPoint& point) { places.add(point.place), values.add(point.values); }
};

std::uint64_t with_value(std::uint64_t word, double value) { return mix(word ^ std::bit_cast<std::uint64_t>(value)); }

/// Returns for each field of the cloud whether its records hold as float64 what a file stores as float32. One value may
/// become different float64 numbers from different files; the nearest float32 is the same.
std::vector<bool> fields_of_singles(const RowSource& rows) {
  std::vector<bool> singles;
  for (const Field& field : rows.schema().fields)
    singles.push_back(field.type == Type::f64 && std::ranges::any_of(rows.files(), [&](const FileOfRows& file) {
                        const auto at = file.schema->find(field.name);
                        return at && file.schema->fields[*at].type == Type::f32;
                      }));
  return singles;
}

class PlacesOfPoints {
 public:
  PlacesOfPoints(InputCloud& cloud, const OutputDivision& division)
      : cloud_(cloud), division_(division), schema_(cloud.schema()), position_(position_fields(schema_, "the output")) {
    if (!division.tile) attribute_ = named(division.split);
    if (division.tile_buffer > 0) buffer_ = named(kBuffer);
  }

  void look(const PhaseProgress& progress) {
    RowSource rows(cloud_);
    singles_ = fields_of_singles(rows);
    const std::span<const FileOfRows> files = rows.files();
    std::size_t next = 0;  // index of the next file
    for_each_row(rows, "comparing", progress, [&](std::uint64_t row, const std::byte* record) {
      for (; next < files.size() && files[next].first == row; ++next) begin(cloud_.readers()[next]->info().path);
      see(row, record);
    });
    if (!buffer_) return;
    // A tile without own points has no file and no buffer. All tiles with own points are known by now.
    for (const auto& [part, sum] : wanted_) {
      if (!file_of_.contains(part)) continue;
      if (sum.places.sum() != found_[part].places.sum())
        misplaced_.add("{}: its buffer does not hold the points around its tile", file_of_.at(part));
      else if (sum.values.sum() != found_[part].values.sum())
        misplaced_.add("{}: points of its buffer have other values than in their own tiles", file_of_.at(part));
    }
    for (const auto& [part, sum] : found_)
      if (!wanted_.contains(part) && sum.places.sum() != 0)
        misplaced_.add("{}: its buffer holds points that are not around its tile", file_of_.at(part));
  }

  /// Returns for each row of the files whether its point belongs to the part itself, not to its buffer.
  const std::vector<bool>& own() const { return own_; }
  const Differences& misplaced() const { return misplaced_; }

 private:
  Field named(const std::string& word) const {
    const auto at = field_meant(schema_, word);
    if (!at)
      fail_usage("{}: has no attribute '{}', by which the points would be divided.",
                 cloud_.readers().front()->info().path.string(), word);
    return schema_.fields[*at];
  }

  double edge(std::size_t axis, double tile) const { return division_.tile_origin[axis] + tile * *division_.tile; }

  /// Returns the part to which a point belongs; in a division into tiles, nothing for a point whose x or y is not
  /// finite.
  std::optional<Part> part_of(const std::byte* record, Vec3 p) const {
    if (!division_.tile) return Part{value_of(*attribute_, record), 0};
    if (!std::isfinite(p.x) || !std::isfinite(p.y)) return std::nullopt;
    Part part;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double value = axis == 0 ? p.x : p.y;
      part[axis] = std::round((value - division_.tile_origin[axis]) / *division_.tile);
      while (edge(axis, part[axis]) > value) --part[axis];
      while (edge(axis, part[axis] + 1) <= value) ++part[axis];
    }
    return part;
  }

  void begin(const std::filesystem::path& path) {
    path_ = path;
    part_.reset();
    name_is_known_ = false;
  }

  void see(std::uint64_t row, const std::byte* record) {
    const Vec3 p = position_in(position_, record);
    const bool is_own = !buffer_ || value_of(*buffer_, record) == 0;
    own_.push_back(is_own);
    if (!is_own) return see_buffer(buffer_point(record, p));
    const std::optional<Part> part = part_of(record, p);
    if (!std::exchange(name_is_known_, true)) take_file(part);
    if (part != part_) misplaced_.add("{}: row {} of all files belongs into another file", path_.string(), row);
    if (buffer_ && part) want_in_buffers(*part, p, record);
  }

  /// Takes the part of the first own point of a file as the part of the file. The file's name must state the same part.
  void take_file(const std::optional<Part>& part) {
    part_ = part;
    for (const BufferPoint& point : std::exchange(waiting_, {})) see_buffer(point);
    take_name(part);
    if (!part) return;
    if (!file_of_.try_emplace(*part, path_.string()).second)
      misplaced_.add("{}: holds the same part as {}", path_.string(), file_of_.at(*part));
  }

  /// Compares the name of the current file with its part. The texts before and after the name of the part are the same
  /// in the names of all files.
  void take_name(const std::optional<Part>& part) {
    std::vector<double> numbers;
    if (part && division_.tile) numbers = {edge(0, (*part)[0]), edge(1, (*part)[1])};
    if (part && !division_.tile) numbers = {(*part)[0]};
    std::set<Surrounding> here = surroundings_in(path_.filename().string(), numbers);
    if (surroundings_) std::erase_if(here, [&](const Surrounding& one) { return !surroundings_->contains(one); });
    if (here.empty())
      misplaced_.add("{}: {}", path_.string(), part ? "is not named after its points" : "has points without a place");
    else
      surroundings_ = std::move(here);
  }

  BufferPoint buffer_point(const std::byte* record, Vec3 p) const {
    const std::uint64_t place = with_value(with_value(with_value(0, p.x), p.y), p.z);
    std::uint64_t values = place;
    for (std::size_t f = 0; f < schema_.fields.size(); ++f) {
      if (schema_.fields[f].name == buffer_->name) continue;
      Field field = schema_.fields[f];
      for (field.count = 1; field.offset < end_of(schema_.fields[f]);
           field.offset += static_cast<std::uint32_t>(size_of(field.type)))
        values = mix(values ^ bits_of(field, record, singles_[f]));
    }
    return {place, values};
  }

  static std::uint32_t end_of(const Field& field) {
    return field.offset + field.count * static_cast<std::uint32_t>(size_of(field.type));
  }

  /// Returns bits that are equal for equal values. `single`: only the nearest float32 counts.
  static std::uint64_t bits_of(const Field& field, const std::byte* record, bool single) {
    const bool is_wide = field.type == Type::i64 || field.type == Type::u64;
    if (is_wide && field.is_plain()) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, record + field.offset, sizeof bits);
      return bits;
    }
    const double value = value_of(field, record);
    if (std::isnan(value)) return std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN());
    return std::bit_cast<std::uint64_t>(single ? static_cast<double>(static_cast<float>(value)) : value);
  }

  void see_buffer(const BufferPoint& point) {
    if (!name_is_known_) return void(waiting_.push_back(point));
    if (part_) found_[*part_].add(point);
  }

  void want_in_buffers(const Part& own, Vec3 p, const std::byte* record) {
    const double width = division_.tile_buffer;
    std::optional<BufferPoint> point;
    for (double i = own[0] - 1; i <= own[0] + 1; ++i)
      for (double j = own[1] - 1; j <= own[1] + 1; ++j) {
        const Part part = {i, j};
        if (part != own && p.x >= edge(0, i) - width && p.x < edge(0, i + 1) + width && p.y >= edge(1, j) - width &&
            p.y < edge(1, j + 1) + width) {
          if (!point) point = buffer_point(record, p);
          wanted_[part].add(*point);
        }
      }
  }

  InputCloud& cloud_;
  const OutputDivision& division_;
  const Schema& schema_;
  PositionFields position_;
  std::optional<Field> attribute_, buffer_;
  std::filesystem::path path_;  ///< path of the current file
  std::optional<Part> part_;    ///< part of the current file; absent for points without a finite place
  bool name_is_known_ = false;
  std::vector<BufferPoint> waiting_;  ///< buffer points of the current file before its first own point
  std::map<Part, std::string> file_of_;
  /// Sums over the points that the buffer of each part must hold, and over the points that the buffer holds.
  std::map<Part, BufferSum> wanted_, found_;
  std::vector<bool> singles_;  ///< fields_of_singles()
  /// The texts before and after the name of the part that are possible for all files so far; absent before the first
  /// file.
  std::optional<std::set<Surrounding>> surroundings_;
  std::vector<bool> own_;
  Differences misplaced_;
};

}  // namespace

OutputDivision recorded_division(const ProvenanceRecord& record) {
  RunOptions options;
  for (const auto& [setting, option] :
       {std::pair{"tiles", "tile"}, {"tile_origin", "tile_origin"}, {"tile_buffer", "tile_buffer"}, {"split", "split"}})
    if (const auto value = record.setting(setting)) run_option(option).set(options, *value, "the record of the output");
  return options.division;
}

DividedOutput read_divided(const std::vector<std::filesystem::path>& files, const OutputDivision& division,
                           const PhaseProgress& progress) {
  InputCloud cloud(files, {.ignore_crs = true});
  PlacesOfPoints places(cloud, division);
  places.look(progress);
  return {.own = division.tile_buffer > 0 ? cloud.selected(selection_of(places.own())) : cloud,
          .misplaced = places.misplaced()};
}

}  // namespace pointsweep
