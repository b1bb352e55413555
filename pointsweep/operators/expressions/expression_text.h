// SPDX-License-Identifier: MIT
/// A reader of the text of an expression, which finds the next signs and words, and reports errors with their column.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pointsweep {

class ExpressionText {
 public:
  /// Messages begin with `where`.
  ExpressionText(std::string_view text, std::string_view where) : text_(text), where_(where) {}

 protected:
  static bool begins_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }
  static bool continues_name(char c) { return begins_name(c) || is_digit(c) || c == '.'; }

  /// Skips blanks, then `sign` if it comes next. Returns whether `sign` came next.
  bool take(std::string_view sign);
  /// Skips blanks, then `word` if it comes next as a whole word. `word` is in lower case; the text may have any case.
  /// Returns whether `word` came next.
  bool take_word(std::string_view word);
  /// Takes the word `not` like take_word(), unless it is the name of an attribute.
  bool take_not();
  void skip_blanks();

  /// Adds an operator with blanks around it to the canonical text.
  void note_binary(std::string_view sign) { canonical_.append(" ").append(sign).append(" "); }

  [[noreturn]] void unexpected(std::string_view wanted) const;
  [[noreturn]] void fail_at(std::size_t at, std::string_view what) const;

  std::string_view text_;
  std::size_t at_ = 0;     ///< index of the first character that has not been read
  std::string canonical_;  ///< canonical form of the text that has been read

 private:
  std::string_view where_;
};

}  // namespace pointsweep
