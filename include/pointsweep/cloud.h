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
  /// True to ignore coordinate reference systems: inputs of different systems are merged without a transformation, with
  /// a warning; degrees are treated as lengths; default lengths are not converted from metres. If false, different
  /// systems and degrees throw a UsageError.
  bool ignore_crs = false;
  /// Coordinate reference system of all inputs; absent to use the systems that the inputs state. Opening the cloud
  /// throws UsageError if an input states another system, or one that cannot be compared, unless StatedCrs::replaces.
  std::optional<StatedCrs> crs = {};
  /// The parameter `format` of open_reader(): the format of files without a signature, "kitti" or "float32-xyz"; the
  /// columns of text files, "text:x,y,z,-,intensity"; or levels of detail, "depth:3" or "spacing:0.5". Empty for none.
  std::string format = "";
};

/// A cloud of points from one or several inputs. Its rows are the rows of the inputs, one input after another. Opening
/// reads headers, and of other files as much as their layout and number of points take; run() reads the points.
///
/// All inputs have one schema: their common schema if all are equal bit by bit; otherwise the union of their fields by
/// name. Coordinates lose nothing: they are float64 unless all are float32, or LAS integers at the finest scale of all
/// inputs if all lie on that grid. Other fields have the smallest type that holds the values of all inputs: int64 for
/// uint64 and a signed type, float64 for integers of 64 bits and real numbers. Reading throws Error for an integer that
/// this type does not hold exactly. A field that an input lacks is 0 there (docs/formats.md has the exceptions) and a
/// warning names both.
///
/// Not thread-safe: one thread uses a cloud at a time.
class POINTSWEEP_EXPORT Cloud {
 public:
  /// Opens files. The content of each file decides its format. Throws Error, with the file, for a file that cannot be
  /// read, and UsageError for different coordinate reference systems.
  explicit Cloud(const std::vector<std::filesystem::path>& files, CloudOptions options = {});
  explicit Cloud(std::initializer_list<std::filesystem::path> files, CloudOptions options = {});
  /// Takes points from elsewhere: ArrayReader, or a reader of your own.
  explicit Cloud(std::unique_ptr<Reader> reader, CloudOptions options = {});
  explicit Cloud(std::vector<std::unique_ptr<Reader>> readers, CloudOptions options = {});
  Cloud(Cloud&&) noexcept;
  Cloud& operator=(Cloud&&) noexcept;
  ~Cloud();

  /// Returns the number of points of all inputs.
  std::uint64_t count() const;
  /// Returns the layout of the records of points, whose fields have the names that the inputs use.
  const Schema& schema() const;
  std::size_t input_count() const;
  /// Returns the facts known about input `i` < input_count().
  const FileInfo& input(std::size_t i) const;
  /// Returns the coordinate reference system in CloudOptions, or else the system of the first input that states one.
  const std::optional<Crs>& crs() const;
  /// Returns sentences about harmless faults in the combination of inputs. FileInfo::warnings has sentences about a
  /// single input.
  const std::vector<std::string>& warnings() const;

  /// Reads the records `row`, `row+1`, ... into `records`: as many whole records of schema().stride bytes as fit, fewer
  /// only at the end of the cloud. Returns their number. Reading in order costs no more than reading the files.
  std::size_t read(std::uint64_t row, std::span<std::byte> records);

  /// Returns the inputs, for the engine; not for users.
  InputCloud& inputs() { return *inputs_; }
  const InputCloud& inputs() const { return *inputs_; }

 private:
  std::unique_ptr<InputCloud> inputs_;
};

}  // namespace pointsweep
