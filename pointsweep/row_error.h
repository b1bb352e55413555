// SPDX-License-Identifier: MIT
/// Errors about the value of a row, and text that callers add to errors. The threads of a run find errors of rows in
/// any order; the run throws the error of the lowest row.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"

namespace pointsweep {

/// The text of a RowError before and after the number of the row.
struct RowSentence {
  std::string before, after;
};

/// An error about the value of one row. Its message contains the number of the row.
class RowError : public Error {
 public:
  RowError(std::uint64_t row, RowSentence sentence) : RowError(row, std::to_string(row), std::move(sentence)) {}
  std::uint64_t row() const { return row_; }
  /// Returns this error with another row number. A pass numbers only the rows that earlier selects have kept, so the
  /// run replaces such a number by the row of the input.
  RowError numbered(std::uint64_t row) const { return {row, sentence_}; }
  /// Returns this error with a sentence that calls the row `name`.
  RowError named(const std::string& name) const { return {row_, name, sentence_}; }
  /// Orders errors by row, then by sentence, so that the least error does not depend on the number of threads.
  bool operator<(const RowError& other) const {
    return std::tie(row_, sentence_.before, sentence_.after) <
           std::tie(other.row_, other.sentence_.before, other.sentence_.after);
  }

 private:
  RowError(std::uint64_t row, const std::string& name, RowSentence sentence)
      : Error(sentence.before + name + sentence.after), row_(row), sentence_(std::move(sentence)) {}

  std::uint64_t row_;
  RowSentence sentence_;
};

/// Calls `work()`. Replaces a RowError by an Error that names the row like "5 of the output": for writers, whose rows
/// differ from the rows of the input.
template <class Work>
void with_rows_of_output(const Work& work) {
  try {
    work();
  } catch (const RowError& error) {
    throw Error(error.named(std::to_string(error.row()) + " of the output").what());
  }
}

/// Calls work(). If work() throws an Error, appends the text that added() returns to its sentence. The Error is
/// unchanged if the text is empty; UsageError and Cancelled are always unchanged.
template <class Work, class Added>
void extending_errors(const Work& work, const Added& added) {
  try {
    work();
  } catch (const UsageError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    const std::string text = added();
    if (text.empty()) throw;
    throw Error(error.what() + text);
  }
}

/// Keeps the least of several errors, as operator< orders them. Not thread-safe.
class FirstRowError {
 public:
  /// Notes an error of `row`. Calls `sentence()`, which returns the RowSentence, only if no lower row has been noted.
  template <class Sentence>
  void note(std::uint64_t row, Sentence sentence) {
    if (!first_ || row <= first_->row()) note(RowError(row, sentence()));
  }
  void note(const RowError& error) {
    if (!first_ || error < *first_) first_.emplace(error);
  }
  void note(const FirstRowError& other) {
    if (other.first_) note(*other.first_);
  }
  /// Calls `work()` and notes a RowError that it throws, so that the caller can go on with other rows.
  template <class Work>
  void note_from(Work work) {
    try {
      work();
    } catch (const RowError& error) {
      note(error);
    }
  }
  bool any() const { return first_.has_value(); }
  void throw_if_any() const {
    if (first_) throw RowError(*first_);
  }

 private:
  std::optional<RowError> first_;
};

}  // namespace pointsweep
