// SPDX-License-Identifier: MIT
/// The cloud between two passes: the input, with what has been made in the place of what the input has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/order/row_file.h"
#include "pointsweep/order/row_store.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Rows of `after`, each value from what the sweep made if it did, otherwise from what was carried into it. All three
/// are records that hold the values of their attributes one after another.
class RowUpdate {
 public:
  RowUpdate(const std::vector<Attribute>& carried, const std::vector<Attribute>& made,
            const std::vector<Attribute>& after);
  std::size_t record_bytes() const { return after_bytes_; }
  /// `carried` may be null if everything is made.
  void run(const std::byte* carried, const std::byte* made, std::size_t n, std::byte* after) const;

 private:
  struct Piece {
    bool made;
    std::size_t from, to, bytes;
  };
  std::vector<Piece> pieces_;
  std::size_t carried_bytes_, made_bytes_, after_bytes_;
};

/// Successive rows: what a pass has made of them, and the same updated. Either may be empty records.
struct UpdatedRows {
  std::uint64_t first;
  std::size_t count;
  const std::byte* made;
  const std::byte* after;
};

/// Gives what a pass has made of all rows, in their order.
using MadeRows = std::function<void(
    const std::function<void(std::uint64_t first_row, std::size_t count, const std::byte* made)>& use)>;

/// Takes the rows of `results`, updated, in their order, at most rows_at_once() at once. `carried` is null before the
/// first pass; `made_bytes` is the size of a record of `results`. On all threads.
void update_rows(const MadeRows& results, const RowFile* carried, const RowUpdate& update, std::size_t made_bytes,
                 const std::function<void(const UpdatedRows&)>& use);

/// Returns the cloud as `pass` sees it: the records of `input`, followed by those of `carried`, which must outlive the
/// source. The input itself is read only if the pass needs something of it.
PointSource updated_source(const PointSource& input, const RowFile& carried, const PlannedPass& pass);

}  // namespace pointsweep
