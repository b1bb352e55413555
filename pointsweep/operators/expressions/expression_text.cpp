// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/expression_text.h"

#include <algorithm>

#include "pointsweep/fail.h"

namespace pointsweep {

bool ExpressionText::take(std::string_view sign) {
  skip_blanks();
  if (!text_.substr(at_).starts_with(sign)) return false;
  at_ += sign.size();
  return true;
}

bool ExpressionText::take_word(std::string_view word) {
  skip_blanks();
  const std::string_view rest = text_.substr(at_);
  const auto is_letter = [](char letter, char c) {
    return c == letter || (c >= 'A' && c <= 'Z' && c - 'A' + 'a' == letter);
  };
  if (rest.size() < word.size() || !std::equal(word.begin(), word.end(), rest.begin(), is_letter)) return false;
  if (rest.size() > word.size() && continues_name(rest[word.size()])) return false;
  at_ += word.size();
  return true;
}

bool ExpressionText::take_not() {
  const std::size_t first = at_;
  if (!take_word("not")) return false;
  skip_blanks();
  const std::string_view rest = text_.substr(at_);
  const bool begins_test = !rest.empty() && !rest.starts_with("!=") &&
                           (continues_name(rest[0]) || rest[0] == '(' || rest[0] == '-' || rest[0] == '!');
  if (!begins_test) at_ = first;
  return begins_test;
}

void ExpressionText::skip_blanks() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
}

void ExpressionText::unexpected(std::string_view wanted) const {
  if (at_ >= text_.size()) fail_at(at_, fmt::format("{} is expected, but the expression ends", wanted));
  fail_at(at_, fmt::format("{} is expected, not '{}'", wanted, text_[at_]));
}

void ExpressionText::fail_at(std::size_t at, std::string_view what) const {
  while (at < text_.size() && text_[at] == ' ') ++at;
  fail_usage("{}: '{}', column {}: {}.", where_, text_, at + 1, what);
}

}  // namespace pointsweep
