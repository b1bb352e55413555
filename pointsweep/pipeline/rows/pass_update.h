// SPDX-License-Identifier: MIT
/// The results of a pass for the next pass: the remaining rows, their carried attributes, values of the whole cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/parallel_rows.h"
#include "pointsweep/pipeline/rows/pass_values.h"
#include "pointsweep/pipeline/rows/row_mask.h"
#include "pointsweep/pipeline/rows/updated_cloud.h"

namespace pointsweep {

class PassUpdate {
 public:
  /// `input`: the rows of `cloud`. `carried_bytes`: of a record of pass.carried.
  PassUpdate(const PlannedPass& pass, InputCloud& cloud, PointSource input, std::size_t carried_bytes,
             const SpillPlace& rows, const SpillPlace& mask);

  /// Takes the next rows. On all threads.
  void add(const UpdatedRows& rows);
  /// After the last row: the cloud has the rows that are left, and the values are known.
  std::unique_ptr<RowFile> finish(CloudValues& values);
  std::uint64_t spilled_bytes() const { return spilled_bytes_; }

 private:
  /// Some of the rows that add() has got, for one thread.
  struct Task {
    std::size_t first, count;
    std::uint64_t place = 0;  ///< of the first that is kept, in rows_
    std::uint64_t kept = 0;
  };
  std::vector<Task> tasks_of(const UpdatedRows& rows);
  void decide(const UpdatedRows& rows, std::vector<Task>& tasks);
  void keep(const UpdatedRows& rows, const Task& task, unsigned worker);
  const std::byte* compact(const std::byte* records, std::size_t bytes, const Task& task,
                           std::vector<std::byte>& room) const;

  struct Room {
    std::vector<std::byte> carried, inputs;
  };

  InputCloud& cloud_;
  std::size_t carried_bytes_, made_bytes_, selection_at_ = 0;  ///< offset of the decision in a made record
  std::unique_ptr<RowFile> rows_;
  std::optional<RowMask> mask_;
  PassValues values_;
  ParallelRows input_rows_;
  std::vector<std::byte> inputs_;   ///< records of the cloud, if a value needs them
  std::vector<std::uint8_t> kept_;  ///< by row, if the pass selects
  std::vector<Room> rooms_;         ///< by thread
  std::uint64_t spilled_bytes_ = 0;
};

}  // namespace pointsweep
