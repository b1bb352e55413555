// SPDX-License-Identifier: MIT
/// The read operator Φ_R, which sorts slabs of the ordered stream, and the deferred-write operator Φ_W (paper
/// Section 4.2.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "pointsweep/order/stream.h"
#include "reference/fields.h"
#include "reference/stream_operator.h"

namespace pointsweep::reference {

/// The points of one slab in canonical order. Place 0 is the first point of the slab.
class SortedSlab {
 public:
  void load(const Stream& stream, std::size_t slab);

  std::size_t size() const { return order_.size(); }
  Vec3 position(std::size_t place) const { return {x_[order_[place]], y_[order_[place]], z_[order_[place]]}; }
  std::uint64_t row(std::size_t place) const { return row_[order_[place]]; }
  const std::byte* record(std::size_t place) const { return records_.data() + std::size_t{order_[place]} * stride_; }

 private:
  std::size_t stride_ = 0;
  std::vector<std::byte> records_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
  std::vector<std::uint32_t> order_;
};

/// Reads and buffers one point at a time, in canonical order. Ordering itself is shared with the engine (order/): the
/// slabs of its stream are read one by one and sorted.
class ReadOperator final : public StreamOperator {
 public:
  /// The slabs of `stream` must be in canonical order (StreamOptions::canonical): the search takes every unread point
  /// to lie at or after the plane.
  ReadOperator(const Stream& stream, const Fields& fields, Reach reach, ActiveSet& active);

  void pull_push() override;
  StreamPoint* front() override { return waiting_; }
  void pop_front() override { waiting_ = nullptr; }
  std::uint64_t smallest_element() override;
  std::uint64_t smallest_reference() override { return kNoIndex; }
  std::size_t size() const override { return waiting_ == nullptr ? 0 : 1; }

  std::uint64_t position() const { return position_; }  ///< number of points read
  std::uint64_t total() const { return total_; }
  /// Returns the error of the lowest row read that has a value which an operator cannot read.
  const FirstRowError& refused() const { return refused_; }

 private:
  const Stream& stream_;
  const Fields& fields_;
  Reach reach_;
  ActiveSet& active_;
  StreamPoint* waiting_ = nullptr;
  std::uint64_t position_ = 0, total_ = 0;

  SortedSlab slab_;  ///< slab whose points are being read
  std::size_t next_slab_ = 0;
  std::size_t next_ = 0;  ///< place of the next point in slab_
  FirstRowError refused_;
};

/// Writes a point and removes it from the active set when no neighbourhood in earlier operators refers to it any more.
class WriteOperator final : public StreamOperator {
 public:
  WriteOperator(ActiveSet& active, std::function<void(StreamPoint&)> write)
      : active_(active), write_(std::move(write)) {}

  void pull_push() override;
  StreamPoint* front() override { return nullptr; }
  void pop_front() override {}
  std::uint64_t smallest_element() override { return fifo_.empty() ? prev_->smallest_element() : fifo_.front()->index; }
  std::uint64_t smallest_reference() override { return prev_->smallest_reference(); }
  std::size_t size() const override { return fifo_.size(); }

  std::uint64_t position() const { return position_; }  ///< number of points written

 private:
  ActiveSet& active_;
  std::function<void(StreamPoint&)> write_;
  std::deque<StreamPoint*> fifo_;
  std::uint64_t position_ = 0;
};

}  // namespace pointsweep::reference
