// SPDX-License-Identifier: MIT
/// The transition from one pass to the next: made attributes replace attributes of the input, dropped rows are removed,
/// attributes that later passes read or the output needs are carried on, and values of the whole cloud become known.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/formats/cloud/row_selection.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/points/record_map.h"

namespace pointsweep {

/// Values of the whole cloud, by PlannedValue::number.
using CloudValues = std::map<std::size_t, std::vector<double>>;

/// Reduces the rows that a pass leaves to the values of the whole cloud that the pass plans (PlannedPass::values).
class PassValues {
 public:
  /// `input`: the schema of the cloud's records.
  PassValues(const PlannedPass& pass, const Schema& input);

  /// Returns whether add() also needs the cloud's records.
  bool needs_input() const { return needs_input_; }
  /// Adds `n` rows that the pass leaves: carried records, and records of the cloud, which may be null if not needed.
  /// `worker`: number of the thread in a parallel loop; several threads with different numbers may call at once.
  void add(unsigned worker, const std::byte* carried, const std::byte* inputs, std::size_t n);
  void finish(CloudValues& into) const;
  /// Returns the state of each value of the pass, for finish_values() in another process.
  std::vector<std::vector<std::byte>> save() const;

 private:
  struct Component {
    Field field;
    bool carried;
  };
  struct Sum {
    PlannedValue value;
    std::vector<Component> reads;
    std::vector<std::unique_ptr<Accumulator>> parts;  ///< one accumulator for each thread

    std::unique_ptr<Accumulator> all() const;
  };
  Component component_of(const Attribute& attribute, std::size_t c, const PlannedPass& pass, const Schema& input);
  Component of_input(const Attribute& attribute, std::size_t c, const Schema& input);

  std::vector<Sum> sums_;
  std::size_t carried_bytes_, input_bytes_;
  bool needs_input_ = false;
};

/// Finishes the values of a pass whose rows are divided among several processes: `saved` has the result of
/// PassValues::save() of each process.
void finish_values(const PlannedPass& pass, const std::vector<std::vector<std::vector<std::byte>>>& saved,
                   CloudValues& into);

/// Returns the pass with the values of the whole cloud that its stages need, bound to `records` (PlannedPass::bind).
PlannedPass ready_pass(PlannedPass pass, const CloudValues& values, const Schema& records);

/// Collects the decisions of a pass that drops rows: one for each row that earlier passes have left. The result is a
/// selection among all rows of the cloud.
class RowMask {
 public:
  /// `before`: the rows that earlier selects have kept of `rows` rows; null: all. It must outlive the mask.
  RowMask(std::uint64_t rows, const RowSelection* before, const SpillPlace& spill);
  /// Appends the decisions about the next rows of `before`: not 0 for a kept row.
  void append(std::span<const std::uint8_t> kept);
  /// Returns the selection. Must be called after the last row.
  RowSelection finish();
  std::uint64_t spilled_bytes() const { return file_->spilled_bytes(); }

  /// Returns the selection of a finished mask that a checkpoint has stored at `kept`.
  static RowSelection kept(std::uint64_t rows, const SpillPlace& kept);
  /// Returns the bytes of a mask of `rows` rows: its bits in whole blocks, and the 8 bytes of memory that a
  /// RowSelection takes for each block.
  static std::uint64_t bytes(std::uint64_t rows);

 private:
  void append_any(bool kept);

  std::uint64_t rows_, next_ = 0;  ///< number of all rows of the cloud, and of rows decided so far
  std::optional<SelectionCursor> before_;
  std::shared_ptr<RowFile> file_;
  std::vector<std::byte> block_;
};

/// Makes the records of rows after a pass. Each value comes from the pass if the pass has made the attribute, otherwise
/// from the rows carried into the pass. All three kinds of records contain the values of their attributes one after
/// another.
class RowUpdate {
 public:
  RowUpdate(const std::vector<Attribute>& carried, const std::vector<Attribute>& made,
            const std::vector<Attribute>& after);
  std::size_t made_bytes() const { return made_bytes_; }
  std::size_t record_bytes() const { return after_bytes_; }
  /// Makes `n` records at `after`. `carried` may be null if the pass has made all attributes of `after`.
  void run(const std::byte* carried, const std::byte* made, std::size_t n, std::byte* after) const;

 private:
  RecordMap from_carried_, from_made_;
  std::size_t carried_bytes_, made_bytes_, after_bytes_;
};

/// Successive rows: the results of a pass (`made`) and the updated rows (`after`). Records of either kind may be empty.
struct UpdatedRows {
  std::uint64_t first;
  std::size_t count;
  const std::byte* made;
  const std::byte* after;
};

/// A function that passes the results of a pass for all rows to `use`, in order.
using MadeRows = std::function<void(
    const std::function<void(std::uint64_t first_row, std::size_t count, const std::byte* made)>& use)>;

/// Updates the rows of `results` on all threads, and passes them to `use` in order, at most rows_at_once() at a time.
/// `carried` is null for the first pass.
void update_rows(const MadeRows& results, const RowFile* carried, const RowUpdate& update,
                 const std::function<void(const UpdatedRows&)>& use);

/// Returns the cloud as `pass` sees it: each record of `input`, followed by the carried record of the row. `carried`
/// must outlive the source. If the pass needs no field of the input, the input is not read, and the bytes of its
/// records are not set.
PointSource updated_source(const PointSource& input, const RowFile& carried, const PlannedPass& pass);

/// Collects the data that a pass leaves to later passes: the carried records of the kept rows, their selection, and
/// values of the whole cloud.
class PassUpdate {
 public:
  /// `input`: the rows of `cloud`. `rows`, `mask`: places for the carried records and for the selection.
  PassUpdate(const PlannedPass& pass, const InputCloud& cloud, PointSource input, const SpillPlace& rows,
             const SpillPlace& mask);

  /// Takes the next rows. Works on all threads.
  void add(const UpdatedRows& rows);
  /// Returns the carried records of the kept rows, and adds the values of the whole cloud to `values`. Must be called
  /// after the last row.
  std::unique_ptr<RowFile> finish(CloudValues& values);
  /// Returns the kept rows of the cloud as a selection of all its rows; none if the pass has no select. Must be called
  /// once, after the last row.
  std::optional<RowSelection> take_selection();
  /// Returns PassValues::save() of the rows that are left.
  std::vector<std::vector<std::byte>> saved_values() const { return values_.save(); }
  std::uint64_t spilled_bytes() const { return spilled_bytes_; }

 private:
  /// A range of the rows passed to add(), for one thread.
  struct Task {
    std::size_t first, count;
    std::uint64_t place = 0;  ///< place of its first kept row in rows_
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

  const InputCloud& cloud_;
  std::size_t carried_bytes_, made_bytes_, selection_at_ = 0;  ///< selection_at_: offset of selection_attribute()
  std::unique_ptr<RowFile> rows_;
  std::optional<RowMask> mask_;
  PassValues values_;
  ParallelRows input_rows_;
  std::vector<std::byte> inputs_;  ///< records of the cloud, if a value needs them
  /// For each row of the latest add(), not 0 if the row is kept. Empty without a select.
  std::vector<std::uint8_t> kept_;
  std::vector<Room> rooms_;  ///< buffers of each thread
  std::uint64_t spilled_bytes_ = 0;
};

}  // namespace pointsweep
