// SPDX-License-Identifier: MIT
/// A reader of several files as one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/reader.h"

namespace pointsweep {

class CloudReader final : public Reader {
 public:
  /// `name`: name of all files together in messages. `left_out`: a field that the reader hides.
  CloudReader(InputCloud cloud, const std::filesystem::path& name, const std::string& left_out = "")
      : cloud_(std::move(cloud)) {
    info_.path = name;
    info_.format = "several files";
    info_.schema = cloud_.schema();
    std::erase_if(info_.schema.fields, [&](const Field& field) { return field.name == left_out; });
    info_.count = cloud_.count();
    info_.bytes = cloud_.bytes();
    info_.crs = cloud_.crs();
    info_.las = cloud_.las();
  }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override { return cloud_.read(row, records); }

 private:
  InputCloud cloud_;
};

}  // namespace pointsweep
