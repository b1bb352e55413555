// SPDX-License-Identifier: MIT
/// The treatment of points whose coordinates are NaN or infinite: EngineOptions::nonfinite.
#pragma once

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/engine_run.h"

namespace pointsweep {

/// `asked`, or where that is by_format: `drop` for formats that cannot hold such points (LAS), `keep` for the others.
/// For tiles: `drop` if the format of any tile cannot hold such points and the input of that tile may have some.
Nonfinite nonfinite_rule(const InputCloud& cloud, const Outputs& outputs, Nonfinite asked);

/// While it lives, the cloud has the rows that the run is to see. Reads the cloud once where rows may be dropped or
/// refused and its coordinates are no integers.
class FiniteInput {
 public:
  /// Throws Error naming the first row where nonfinite points are refused, where the output cannot hold them although
  /// they are to be kept, and where no other points are left.
  FiniteInput(InputCloud& cloud, const Outputs& outputs, const EngineOptions& options);
  ~FiniteInput();
  FiniteInput(const FiniteInput&) = delete;
  FiniteInput& operator=(const FiniteInput&) = delete;

  /// Nothing was looked for, or nothing found, if its count is 0.
  const NonfiniteRows& dropped() const { return dropped_; }
  /// "Dropped 3 points whose coordinates are not finite ..."; empty if none were.
  std::string warning() const;

 private:
  InputCloud& cloud_;
  NonfiniteRows dropped_;
};

}  // namespace pointsweep
