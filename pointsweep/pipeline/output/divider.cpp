// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/divider.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/field_names.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/operators/expressions/expression.h"
#include "pointsweep/storage/local/unfinished_output.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

/// FileKey::first of the file for points whose x or y is not finite; no tile has this number.
constexpr std::int64_t kUnplaced = std::numeric_limits<std::int64_t>::min();

constexpr int kMostTileDigits = 17;
/// If a tile is larger than this share of the coordinate and of the origin, edges near the coordinate are distinct in
/// float64, and floor((coordinate - origin) / size) is the number of its tile or of an adjacent tile.
constexpr double kLeastPart = 0x1p-48;

/// Returns the least number of digits after the decimal point with which the text is read back as the same value, at
/// most kMostTileDigits.
int digits_of(double value) {
  int digits = 0;
  while (digits < kMostTileDigits && std::strtod(fmt::format("{:.{}f}", value, digits).c_str(), nullptr) != value)
    ++digits;
  return digits;
}

fs::path with_name(const fs::path& pattern, const std::string& name) {
  std::string file = pattern.filename().string();
  return pattern.parent_path() / file.replace(file.find('*'), 1, name);
}

/// Replaces all characters except ASCII letters, digits, - and . by _.
std::string as_file_name(std::string name) {
  for (char& c : name)
    if (!(c >= 'a' && c <= 'z') && !(c >= 'A' && c <= 'Z') && !(c >= '0' && c <= '9') && c != '-' && c != '.') c = '_';
  return name;
}

/// Returns the attribute that marks points of a neighbouring tile.
Attribute buffer_attribute() {
  return scalar("buffer", Type::u8, "1", "1: the point is in the buffer, and belongs to a neighbouring tile");
}

}  // namespace

std::size_t FileKeyHash::operator()(const FileKey& key) const {
  return mix(mix(std::bit_cast<std::uint64_t>(key.first)) ^ std::bit_cast<std::uint64_t>(key.second));
}

std::size_t files_with_points(std::span<const DividedFile> files) {
  return static_cast<std::size_t>(std::ranges::count_if(files, [](const DividedFile& file) { return file.own > 0; }));
}

TileGrid::TileGrid(double size, const std::array<double, 2>& origin) : size_(size), origin_(origin), digits_{} {
  for (std::size_t axis = 0; axis < 2; ++axis) digits_[axis] = std::max(digits_of(size), digits_of(origin[axis]));
}

std::int64_t TileGrid::tile_of(std::size_t axis, double coordinate) const {
  const double origin = origin_[axis];
  if (!(size_ > kLeastPart * std::max(std::abs(coordinate), std::abs(origin))))
    fail_usage("--tile: tiles of {} have no edges that float64 tells apart at {} = {}; choose larger ones.", size_,
               "xy"[axis], coordinate);
  auto tile = static_cast<std::int64_t>(std::floor((coordinate - origin) / size_));
  while (coordinate < edge(axis, tile)) --tile;
  while (coordinate >= edge(axis, tile + 1)) ++tile;
  return tile;
}

std::string TileGrid::edge_text(std::size_t axis, std::int64_t tile) const {
  return fmt::format("{:.{}f}", edge(axis, tile) + 0.0, digits_[axis]);
}

Divider::Divider(OutputPlan plan, const OutputDivision& division)
    : plan_(std::move(plan)), division_(division), record_bytes_(plan_.schema.stride) {
  if (division_.tile) {
    grid_.emplace(*division_.tile, division_.tile_origin);
    const PositionFields position = position_fields(plan_.schema, plan_.path.string());
    xy_ = {position.x, position.y};
  } else {
    choose_attribute(division_.split);
  }
  if (has_buffers()) {
    const Attribute buffer = buffer_attribute();
    if (plan_.schema.find(buffer.name))
      fail_usage(
          "--tile-buffer: the points have an attribute '{0}' already; leave out an earlier buffer with "
          "--pipeline 'where({0} == 0) | drop({0})'.",
          buffer.name);
    plan_.schema.append(buffer.name, buffer.type);
    plan_.made.push_back(buffer);
  }
  const Format* const format = format_of_output(plan_.path);
  if (grid_ && format != nullptr && format->stored_coordinate != nullptr) stored_ = format->stored_coordinate(plan_);
}

void Divider::require_writable() const {
  OutputPlan trial = plan_;
  trial.path = with_name(plan_.path, "tile");
  trial.overwrite = true;
  create_writer(trial);
}

void Divider::choose_attribute(const std::string& word) {
  attribute_ = named_field(plan_.schema, word, "--split");
  if (!has_whole_numbers(attribute_) || attribute_.count != 1)
    fail_usage(
        "--split: '{0}' has no whole numbers, so that nearly each point might get a file; make whole numbers of it, "
        "e.g. pointsweep run INPUT OUTPUT --pipeline 'set(part = floor({1}), as=int32)' --split part.",
        word, spelled_name(attribute_.name));
  attribute_name_ = as_file_name(library_name_of(attribute_.name));
}

double Divider::coordinate_of(std::size_t axis, const std::byte* record) const {
  const double coordinate = value_of(xy_[axis], record);
  return stored_ ? stored_(axis, coordinate) : coordinate;
}

FileKey Divider::key_of(const std::byte* record) const {
  if (!grid_) return {whole_number_of(attribute_, record), 0};  // a u64 may wrap; name_of() converts it back
  std::array<std::int64_t, 2> tile{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double coordinate = coordinate_of(axis, record);
    if (!std::isfinite(coordinate)) return {kUnplaced, 0};
    tile[axis] = grid_->tile_of(axis, coordinate);
  }
  return {tile[0], tile[1]};
}

/// A buffer is at most as wide as a tile, so only the eight tiles around the point's tile can contain the point in
/// their buffer.
void Divider::for_each_buffer(const std::byte* record, const FileKey& own,
                              const std::function<void(FileKey)>& use) const {
  if (is_unplaced(own)) return;
  const std::array<std::int64_t, 2> tile = {own.first, own.second};
  std::array<std::array<bool, 3>, 2> reaches{};  // [axis][i]: whether the coordinate is in tile - 1 + i or its buffer
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double coordinate = coordinate_of(axis, record);
    reaches[axis] = {coordinate < grid_->edge(axis, tile[axis]) + division_.tile_buffer, true,
                     coordinate >= grid_->edge(axis, tile[axis] + 1) - division_.tile_buffer};
  }
  for (std::size_t x = 0; x < 3; ++x)
    for (std::size_t y = 0; y < 3; ++y)
      if (reaches[0][x] && reaches[1][y] && !(x == 1 && y == 1))
        use({tile[0] + static_cast<std::int64_t>(x) - 1, tile[1] + static_cast<std::int64_t>(y) - 1});
}

void Divider::copy(const std::byte* record, bool is_own, std::byte* to) const {
  std::memcpy(to, record, record_bytes_);
  if (has_buffers()) to[record_bytes_] = std::byte{is_own ? std::uint8_t{0} : std::uint8_t{1}};
}

std::string Divider::name_of(const FileKey& key) const {
  if (is_unplaced(key)) return "unplaced";
  if (grid_) return grid_->edge_text(0, key.first) + "_" + grid_->edge_text(1, key.second);
  if (attribute_.type == Type::u64)
    return fmt::format("{}_{}", attribute_name_, std::bit_cast<std::uint64_t>(key.first));
  return fmt::format("{}_{}", attribute_name_, key.first);
}

fs::path Divider::path_of(const FileKey& key) const { return with_name(plan_.path, name_of(key)); }

OutputPlan Divider::plan_of(const DividedFile& file) const {
  OutputPlan plan = plan_;
  plan.path = path_of(file.key);
  plan.count = file.all;
  return plan;
}

bool Divider::is_unplaced(const FileKey& key) const { return grid_ && key.first == kUnplaced; }

void Divider::require_few(std::size_t files) const {
  if (files > kMostFiles && !plan_.overwrite)
    fail_usage("{}: more than {} files would be written; choose {}, or allow it (--force).",
               folder_of(plan_.path).string(), kMostFiles,
               grid_ ? "larger tiles" : "an attribute that has fewer values");
}

}  // namespace pointsweep
