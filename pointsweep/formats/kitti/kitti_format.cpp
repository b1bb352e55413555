// SPDX-License-Identifier: MIT

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/formats/format.h"
#include "pointsweep/formats/records/record_readers.h"
#include "pointsweep/reader.h"

namespace pointsweep {
namespace {

class FloatRecords final : public ColumnsReader {
 public:
  /// `other`: formats to suggest if the file does not hold a whole number of points.
  FloatRecords(const std::filesystem::path& path, const char* asked_for_as, const char* format,
               std::initializer_list<const char*> names, const char* other) {
    auto file = std::make_shared<const InputFile>(path);
    info_.path = path;
    info_.format = format;
    info_.asked_for_as = asked_for_as;
    info_.bytes = file->size();
    for (const char* name : names) info_.schema.append(name, Type::f32);
    const std::uint32_t stride = info_.schema.stride;
    if (file->size() % stride != 0)
      fail("{}: has {} bytes, which is no multiple of the {} of a point ({}); it is incomplete, or {}.", path.string(),
           file->size(), stride, format, other);
    info_.count = file->size() / stride;
    has_records(std::move(file), 0);
  }
};

/// Opens a file of x, y, z and intensity of each point, as in the scans of the KITTI data sets. Throws Error if the
/// size is not a multiple of 16 bytes.
std::unique_ptr<Reader> open_kitti(const std::filesystem::path& path) {
  return std::make_unique<FloatRecords>(path, "kitti", "KITTI, float32 x y z intensity",
                                        std::initializer_list<const char*>{"x", "y", "z", "intensity"},
                                        "has points without intensity (--format float32-xyz)");
}

/// Opens a file of x, y, z of each point. Throws Error if the size is not a multiple of 12 bytes.
std::unique_ptr<Reader> open_float_xyz(const std::filesystem::path& path) {
  return std::make_unique<FloatRecords>(path, "float32-xyz", "float32 x y z",
                                        std::initializer_list<const char*>{"x", "y", "z"},
                                        "has points with intensity (--format kitti)");
}

constexpr std::string_view kKittiExtensions[] = {".bin"};

}  // namespace

const Format kKittiFormat = {.name = "KITTI",
                             .title = "KITTI",
                             .details = "#files-without-a-signature",
                             .reads = "float32 x y z intensity, with `--format kitti`",
                             .writes = "no",
                             .extensions = kKittiExtensions,
                             .asked_for_as = "kitti",
                             .open = open_kitti};

const Format kFloatXyzFormat = {.name = "float32 records",
                                .title = "float32 records",
                                .details = "#files-without-a-signature",
                                .reads = "float32 x y z, with `--format float32-xyz`",
                                .writes = "no",
                                .extensions = {},
                                .asked_for_as = "float32-xyz",
                                .open = open_float_xyz};

}  // namespace pointsweep
