// SPDX-License-Identifier: MIT
/// The input of a run: one cloud made of files, or of points from readers of your own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/crs.h"
#include "pointsweep/export.h"
#include "pointsweep/reader.h"

namespace pointsweep {

class InputCloud;

struct CloudOptions {
  /// Ignores coordinate reference systems: inputs of different systems are merged without a transformation, with a
  /// warning, degrees are treated as lengths, and default lengths are not converted from metres. If false, the first
  /// two throw a UsageError.
  bool ignore_crs = false;
  /// The coordinate reference system of all inputs. Throws UsageError if an input states another system, or one that
  /// cannot be compared, unless StatedCrs::replaces. Absent: the systems that the inputs state.
  std::optional<StatedCrs> crs = {};
  /// Format of files without a signature: "kitti" or "float32-xyz"; or "text:x,y,z,-,intensity", the columns of text
  /// files; or "depth:3" or "spacing:0.5", levels of detail (open_reader).
  std::string format = "";
};

/// Rows run through the inputs in the order given. Opening reads headers; points are read by run().
///
/// All inputs have one schema: their common schema if all are equal bit by bit; otherwise the union of their fields by
/// name. Coordinates lose nothing: they are float64 unless all are float32, or LAS integers at the finest scale of all
/// inputs if all lie on that grid. Other fields have the smallest type that holds the values of all inputs. A field
/// that an input lacks is 0 there (docs/formats.md has the exceptions) and a warning names both.
///
/// Not thread-safe: one thread uses a cloud at a time.
class POINTSWEEP_EXPORT Cloud {
 public:
  /// Opens files. Their contents tell the formats. Throws Error, with the file, for a file that cannot be read, and
  /// UsageError for different coordinate reference systems.
  explicit Cloud(const std::vector<std::filesystem::path>& files, CloudOptions options = {});
  explicit Cloud(std::initializer_list<std::filesystem::path> files, CloudOptions options = {});
  /// Takes points from elsewhere: ArrayReader, or a reader of your own.
  explicit Cloud(std::unique_ptr<Reader> reader, CloudOptions options = {});
  explicit Cloud(std::vector<std::unique_ptr<Reader>> readers, CloudOptions options = {});
  Cloud(Cloud&&) noexcept;
  Cloud& operator=(Cloud&&) noexcept;
  ~Cloud();

  /// Points of all inputs.
  std::uint64_t count() const;
  /// The attributes of a point, by the names of the inputs, and how a record holds them.
  const Schema& schema() const;
  std::size_t input_count() const;
  /// Returns the facts known about input `i` < input_count().
  const FileInfo& input(std::size_t i) const;
  /// Returns the coordinate reference system in CloudOptions, or else that of the first input that states one.
  const std::optional<Crs>& crs() const;
  /// Harmless faults in the combination of inputs, one sentence each. Faults of a single input are in its FileInfo.
  const std::vector<std::string>& warnings() const;

  /// Reads the records `row`, `row+1`, ... into `records`: as many whole records of schema().stride bytes as fit, fewer
  /// only at the end of the cloud. Returns their number. Reading in order costs no more than reading the files.
  std::size_t read(std::uint64_t row, std::span<std::byte> records);

  /// Gives the engine access; not for users.
  InputCloud& inputs() { return *inputs_; }
  const InputCloud& inputs() const { return *inputs_; }

 private:
  std::unique_ptr<InputCloud> inputs_;
};

}  // namespace pointsweep
