// SPDX-License-Identifier: MIT
/// A generated cloud of any size, read like a file although it is stored nowhere.
#pragma once

#include <cstdint>
#include <memory>

#include "pointsweep/program/generate.h"
#include "pointsweep/shapes/registry.h"

namespace pointsweep {

/// The reader that generated_points() documents.
class ShapeReader final : public Reader {
 public:
  /// Throws UsageError for a value out of range.
  ShapeReader(std::shared_ptr<const Shape> shape, const Sampling& sampling);

  /// Makes the records on all threads, 5 to 50 million points a second and core.
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override;

 private:
  SurfacePoint point(std::uint64_t row) const;
  void store(std::uint64_t row, std::byte* record) const;

  std::shared_ptr<const Shape> shape_;
  Sampling sampling_;
  Box outlier_box_;
};

}  // namespace pointsweep
