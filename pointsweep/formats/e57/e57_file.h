// SPDX-License-Identifier: MIT
/// The scans that an E57 file describes, and the values of their points, through the codec (codecs/).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/storage/local/input_file.h"

struct psc_e57;
struct psc_e57_reader;

namespace pointsweep {

struct E57Attribute {
  enum class Kind : std::uint8_t { single, real, scaled_integer, integer };
  std::string name;  ///< name in the file, e.g. "cartesianX"
  Kind kind = Kind::real;
  std::int64_t least = 0, most = 0;  ///< range of stored integers, before scale and offset
  double scale = 1, offset = 0;      ///< value = integer * scale + offset; 1 and 0 unless kind is scaled_integer

  bool is_stored_as_integer() const { return kind == Kind::scaled_integer || kind == Kind::integer; }
  /// Returns the value for a `stored` number that E57File::Points::read() returns.
  double value(std::uint64_t stored) const;
};

struct E57Scan {
  std::uint64_t points = 0;
  std::vector<E57Attribute> attributes;
  bool has_pose = false;
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< unit quaternion w, x, y, z
  std::array<double, 3> translation{};
  std::string description = {};
};

class E57File {
 public:
  /// Throws Error if the file is damaged, or no codecs are built in.
  explicit E57File(const std::filesystem::path& path);

  const InputFile& file() const { return *file_; }
  const std::vector<E57Scan>& scans() const { return scans_; }
  std::size_t images() const { return images_; }
  const std::string& coordinate_system() const { return coordinate_system_; }  ///< WKT; empty if there is none

  /// A reader of the points of one scan, from the first to the last.
  class Points {
   public:
    Points(const E57File& file, std::size_t scan);
    ~Points();
    Points(const Points&) = delete;
    Points& operator=(const Points&) = delete;

    std::size_t scan() const { return scan_; }
    std::uint64_t next() const { return next_; }  ///< row in the scan of the next point
    /// Reads one number for each attribute of each point: a stored integer, or the bits of a double. The scan must have
    /// at least as many points left. Throws Error for a damaged file.
    void read(std::span<std::uint64_t> values);

   private:
    const E57File& file_;
    std::size_t scan_;
    std::uint64_t next_ = 0;
    psc_e57_reader* reader_ = nullptr;
  };

 private:
  std::unique_ptr<const InputFile> file_;
  std::shared_ptr<const psc_e57> codec_;
  std::vector<E57Scan> scans_;
  std::size_t images_ = 0;
  std::string coordinate_system_;
};

}  // namespace pointsweep
