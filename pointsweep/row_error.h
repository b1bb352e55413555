// SPDX-License-Identifier: MIT
/// An error of one row. Rows come in any order to the threads of a run, which throws the error of the lowest one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pointsweep/error.h"

namespace pointsweep {

class RowError : public Error {
 public:
  RowError(std::uint64_t row, const std::string& sentence) : Error(sentence), row_(row) {}
  std::uint64_t row() const { return row_; }

 private:
  std::uint64_t row_;
};

/// The error of the lowest row so far.
class FirstRowError {
 public:
  /// Calls `sentence()` and keeps what it returns if `row` is the lowest so far.
  template <class Sentence>
  void note(std::uint64_t row, Sentence sentence) {
    if (!first_ || row < first_->row()) first_.emplace(row, sentence());
  }
  void note(const RowError& error) {
    if (!first_ || error.row() < first_->row()) first_.emplace(error);
  }
  void note(const FirstRowError& other) {
    if (other.first_) note(*other.first_);
  }
  bool any() const { return first_.has_value(); }
  void throw_if_any() const {
    if (first_) throw RowError(*first_);
  }

 private:
  std::optional<RowError> first_;
};

}  // namespace pointsweep
