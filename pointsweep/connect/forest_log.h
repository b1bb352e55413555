// SPDX-License-Identifier: MIT
/// The votes that decide about each component of a graph, and the log of a spanning forest: the merges of supernodes
/// (sets of points that the forest has joined) and the complete components. The log is written forwards and read
/// backwards, so that the component of a supernode is read before the supernodes that were merged into it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/points/scratch.h"

namespace pointsweep {

/// A rule that decides about each component of a graph by votes: values gathered over the points of the component, such
/// as sums, some of which depend on the signs of the points (ForestEdge). Votes are bytes that can be copied; they
/// depend on the set of points and on their signs, not on the order of merges. A ballot holds the values of a point
/// from which start() makes its votes.
class VoteRule {
 public:
  virtual ~VoteRule() = default;
  virtual std::size_t ballot_bytes() const = 0;
  virtual std::size_t bytes() const = 0;
  /// Sets `votes` to the votes of one point.
  virtual void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const = 0;
  /// Adds the votes `from` to `into`. If `flips`, the points of `from` count with opposite signs.
  virtual void merge(std::byte* into, const std::byte* from, bool flips) const = 0;
  /// Returns the size in bytes of a result, which replaces the votes of a whole component.
  virtual std::size_t result_bytes() const = 0;
  virtual void conclude(const std::byte* votes, std::byte* result) const = 0;
  /// Returns whether the component gets a number.
  virtual bool counts(const std::byte* result) const {
    (void)result;
    return true;
  }
  /// Returns whether all signs of the component must be turned.
  virtual bool turns(const std::byte* result) const {
    (void)result;
    return false;
  }
};

/// The first point and the number of points of a whole component or of a supernode. In the log, the result of the
/// component's votes follows.
struct FinishedComponent {
  PointKey first;  ///< the first point of the component by key
  std::uint64_t points = 0;
};

/// Records of one size, appended one by one, and read from any place or backwards.
class ScratchRecords {
 public:
  ScratchRecords(std::unique_ptr<Scratch> scratch, std::size_t record_bytes);
  void append(const void* record);
  /// Writes the records that are still in memory. Must be called before records are read.
  void finish();
  std::uint64_t count() const { return count_; }
  std::size_t record_bytes() const { return bytes_; }
  /// Reads the records [first, first + out.size() / record_bytes()).
  void read(std::uint64_t first, std::span<std::byte> out) const { scratch_->read(first * bytes_, out); }
  /// Reads the records one by one, from the last to the first.
  class Backwards {
   public:
    explicit Backwards(const ScratchRecords& records) : records_(records), first_(records.count()) {}
    /// Returns the next record in this direction; null after the first record has been returned.
    const std::byte* next();

   private:
    const ScratchRecords& records_;
    std::uint64_t first_;  ///< number of the first record of `block_`
    std::uint64_t left_ = 0;
    std::vector<std::byte> block_;
  };

 private:
  std::unique_ptr<Scratch> scratch_;
  std::size_t bytes_;
  std::uint64_t count_ = 0;
  std::vector<std::byte> block_;
};

/// The label of a component, or of a point in its component.
struct ComponentLabel {
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::uint64_t number = kNone;       ///< number of the component; kNone if its votes give it none
  std::uint64_t points = 0;           ///< number of points of the component
  bool flips = false;                 ///< true if all signs of the component, or the sign of the point, must be turned
  const std::byte* result = nullptr;  ///< result of the votes of the component
};

/// Writes and reads the log. A supernode is identified by its slot, which a later supernode may use again.
class ForestLog {
 public:
  ForestLog(const MakeScratch& make_scratch, std::size_t result_bytes);
  /// Appends a record: the supernode in `slot`, made for the point `row`, became part of the supernode in slot `to`.
  /// `flips`: true if the signs of the two supernodes differ.
  void merged(std::uint64_t row, std::uint32_t slot, std::uint32_t to, bool flips);
  /// Appends a record: the supernode in `slot`, made for the point `row`, is a whole component.
  void finished(std::uint64_t row, std::uint32_t slot, const FinishedComponent& component, const std::byte* result);
  /// Ends the log. Must be called after the last merged() and finished().
  void finish();

  std::uint64_t bytes() const;
  /// Returns the log of components, whose records hold a FinishedComponent and the result of its votes.
  const ScratchRecords& components() const { return components_; }
  /// Calls use(row, label) for each point; the label is valid during the call. Calls label_of() for each component,
  /// from the last to the first and before the points of the component, with its index in components() and its record.
  /// label_of() returns the label of the component. Points of several components may alternate.
  void for_each_point(const std::function<ComponentLabel(std::uint64_t component, const std::byte* record)>& label_of,
                      const std::function<void(std::uint64_t row, const ComponentLabel& label)>& use) const;

 private:
  void append(const FinishedComponent& component, const std::byte* result);

  ScratchRecords merges_, components_;
  std::uint32_t slots_ = 0;
  std::vector<std::byte> record_;
};

}  // namespace pointsweep
