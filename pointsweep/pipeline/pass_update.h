// SPDX-License-Identifier: MIT
/// What a pass leaves to the next: the rows that are left, what is carried of them, and the values of the whole cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/formats/input_cloud.h"
#include "pointsweep/pipeline/pass_values.h"
#include "pointsweep/pipeline/row_mask.h"
#include "pointsweep/pipeline/updated_cloud.h"

namespace pointsweep {

class PassUpdate {
 public:
  /// `carried_bytes`: of a record of pass.carried.
  PassUpdate(const PlannedPass& pass, InputCloud& cloud, std::size_t carried_bytes, const SpillPlace& rows,
             const SpillPlace& mask);

  /// The next rows. Returns the bytes read of the cloud.
  std::uint64_t add(const UpdatedRows& rows);
  /// After the last row: the cloud has the rows that are left, and the values are known.
  std::unique_ptr<RowFile> finish(CloudValues& values);
  std::uint64_t spilled_bytes() const { return spilled_bytes_; }

 private:
  std::size_t leave_out(const UpdatedRows& rows);
  static void compact(std::vector<std::byte>& records, std::size_t bytes, const std::vector<bool>& kept);

  InputCloud& cloud_;
  std::size_t carried_bytes_, made_bytes_, selection_at_ = 0;  ///< offset of the decision in a made record
  std::unique_ptr<RowFile> rows_;
  std::optional<RowMask> mask_;
  PassValues values_;
  std::vector<bool> kept_;
  std::vector<std::byte> carried_, inputs_;
  std::uint64_t spilled_bytes_ = 0;
};

}  // namespace pointsweep
