// SPDX-License-Identifier: MIT
#include "pointsweep/operators/expressions/expression.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {
namespace {

constexpr std::pair<std::string_view, Operation> kComparisons[] = {
    {"==", Operation::equal},         {"!=", Operation::unequal}, {"<=", Operation::less_equal},
    {">=", Operation::greater_equal}, {"<", Operation::less},     {">", Operation::greater}};

using Node = Expression::Node;

bool begins_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// A reader of the text of an expression, which finds the next signs and words, and reports errors with their column.
class ExpressionText {
 public:
  /// Messages begin with `where`.
  ExpressionText(std::string_view text, std::string_view where) : text_(text), where_(where) {}

 protected:
  /// Skips blanks, then `sign` if it comes next. Returns whether `sign` came next.
  bool take(std::string_view sign) {
    skip_blanks();
    if (!text_.substr(at_).starts_with(sign)) return false;
    at_ += sign.size();
    return true;
  }
  /// Skips blanks, then `word` if it comes next as a whole word. `word` is in lower case; the text may have any case.
  /// Returns whether `word` came next.
  bool take_word(std::string_view word) {
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
  /// Takes the word `not` like take_word(), unless it is the name of an attribute.
  bool take_not() {
    const std::size_t first = at_;
    if (!take_word("not")) return false;
    skip_blanks();
    const std::string_view rest = text_.substr(at_);
    const bool begins_test = !rest.empty() && !rest.starts_with("!=") &&
                             (continues_name(rest[0]) || std::string_view("(-!`").find(rest[0]) != rest.npos);
    if (!begins_test) at_ = first;
    return begins_test;
  }
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
  }

  /// Adds an operator with blanks around it to the canonical text.
  void note_binary(std::string_view sign) { canonical_.append(" ").append(sign).append(" "); }

  [[noreturn]] void unexpected(std::string_view wanted) const {
    if (at_ >= text_.size()) fail_at(at_, fmt::format("{} is expected, but the expression ends", wanted));
    fail_at(at_, fmt::format("{} is expected, not '{}'", wanted, first_character(text_.substr(at_))));
  }
  [[noreturn]] void fail_at(std::size_t at, std::string_view what) const {
    while (at < text_.size() && text_[at] == ' ') ++at;
    fail_usage("{}: '{}', column {}: {}.", where_, text_, at + 1, what);
  }

  std::string_view text_;
  std::size_t at_ = 0;     ///< index of the first character that has not been read
  std::string canonical_;  ///< canonical form of the text that has been read

 private:
  std::string_view where_;
};

/// A parser by recursive descent through the grammar in the header.
class ExpressionParser : private ExpressionText {
 public:
  ExpressionParser(std::string_view text, std::string_view where, std::vector<Expression::Name>& names)
      : ExpressionText(text, where), names_(names) {}

  Node whole_text(Expression::Form form) {
    const bool is_condition = form == Expression::Form::condition;
    Node root = either();
    skip_blanks();
    if (at_ < text_.size()) unexpected(is_condition ? "an operator such as && or the end" : "an operator or the end");
    return is_condition ? condition(std::move(root), 0) : number(std::move(root), 0);
  }

  std::string canonical() && { return std::move(canonical_); }

 private:
  Node either() {
    return chain(Operation::either, "||", "or", [this] { return both(); });
  }
  Node both() {
    return chain(Operation::both, "&&", "and", [this] { return test(); });
  }

  template <class Part>
  Node chain(Operation operation, std::string_view sign, std::string_view word, Part part) {
    const std::size_t first = at_;
    Node node = part();
    while (take(sign) || take_word(word)) {
      note_binary(sign);
      Node left = condition(std::move(node), first);
      const std::size_t second = at_;
      Node right = condition(part(), second);
      node = {.operation = operation, .parts = {std::move(left), std::move(right)}};
    }
    return node;
  }

  Node test() {
    const Depth depth(*this);
    skip_blanks();
    if (!((text_.substr(at_, 2) != "!=" && take("!")) || take_not())) return comparison();
    canonical_ += '!';
    const std::size_t first = at_;
    return negated_test(condition(test(), first));
  }

  Node comparison() {
    const std::size_t first = at_;
    Node left = sum();
    for (const auto& [sign, operation] : kComparisons) {
      if (!take(sign)) continue;
      note_binary(sign);
      left = number(std::move(left), first);
      const std::size_t second = at_;
      Node right = number(sum(), second);
      return {.operation = operation, .parts = {std::move(left), std::move(right)}};
    }
    const std::size_t second = at_;
    const bool is_negated = take_word("not");
    if (take_word("in")) {
      note_binary(is_negated ? "not in" : "in");
      if (!take("(")) unexpected("a list of numbers such as (2, 9)");
      Node node{.operation = Operation::among, .parts = {number(std::move(left), first)}};
      arguments(node.parts);
      return is_negated ? negated_test(std::move(node)) : node;
    }
    if (take_word("between")) {
      note_binary(is_negated ? "not between" : "between");
      Node node{.operation = Operation::between, .parts = {number(std::move(left), first), bound()}};
      if (!take_word("and")) unexpected("'and' with the upper bound, as in between 2 and 5,");
      note_binary("and");
      node.parts.push_back(bound());
      return is_negated ? negated_test(std::move(node)) : node;
    }
    if (is_negated) fail_at(second, "'in' or 'between' is expected after 'not'");
    skip_blanks();
    if (text_.substr(at_, 1) == "=") fail_at(at_, "'=' compares nothing; write ==");
    return left;
  }

  static Node negated_test(Node part) { return {.operation = Operation::no, .parts = {std::move(part)}}; }

  Node bound() {
    const std::size_t first = at_;
    return number(sum(), first);
  }

  /// Parses expressions separated by commas, and the ")" after them.
  void arguments(std::vector<Node>& to) {
    canonical_ += '(';
    do {
      if (canonical_.back() != '(') canonical_ += ", ";
      to.push_back(bound());
    } while (take(","));
    if (!take(")")) unexpected("',' or ')'");
    canonical_ += ')';
  }

  Node sum() {
    return arithmetic([this] { return product(); }, '+', Operation::add, '-', Operation::subtract);
  }
  Node product() {
    return arithmetic([this] { return factor(); }, '*', Operation::multiply, '/', Operation::divide);
  }

  template <class Part>
  Node arithmetic(Part part, char sign, Operation operation, char other_sign, Operation other) {
    const std::size_t first = at_;
    Node node = part();
    while (true) {
      const bool is_first = take(std::string_view(&sign, 1));
      if (!is_first && !take(std::string_view(&other_sign, 1))) return node;
      note_binary(std::string_view(is_first ? &sign : &other_sign, 1));
      Node left = number(std::move(node), first);
      const std::size_t second = at_;
      Node right = number(part(), second);
      node = {.operation = is_first ? operation : other, .parts = {std::move(left), std::move(right)}};
    }
  }

  Node factor() {
    const Depth depth(*this);
    skip_blanks();
    if (at_ >= text_.size()) unexpected("an attribute or a number");
    if (take("-")) {
      canonical_ += '-';
      return negated(number(factor(), at_));
    }
    if (take("(")) {
      canonical_ += '(';
      Node inner = either();
      if (!take(")")) unexpected("')'");
      canonical_ += ')';
      return inner;
    }
    if (text_[at_] == '`') return quoted_name();
    if (begins_name(text_[at_])) return name();
    if (is_digit(text_[at_]) || text_[at_] == '.') return literal();
    unexpected("an attribute or a number");
  }

  static Node negated(Node part) {
    if (part.operation == Operation::number && part.whole.value_or(0) <= WholeNumber{1} << 63) {
      part.number = -part.number;
      if (part.whole) part.whole = -*part.whole;
      return part;
    }
    return {.operation = Operation::negate, .parts = {std::move(part)}};
  }

  Node name() {
    const std::size_t first = at_;
    while (at_ < text_.size() && continues_name(text_[at_])) ++at_;
    const std::string_view word = text_.substr(first, at_ - first);
    canonical_ += word;
    if (take("(")) return call(word, first);
    return attribute(word, first);
  }
  Node quoted_name() {
    const std::size_t first = at_, last = text_.find('`', at_ + 1);
    if (last == text_.npos) fail_at(first, "the ` that begins here has no second one");
    const std::string_view name = text_.substr(first + 1, last - first - 1);
    if (name.empty()) fail_at(first, "a name is expected between two `");
    canonical_ += spelled_name(name);
    at_ = last + 1;
    return attribute(name, first);
  }
  Node attribute(std::string_view name, std::size_t first) {
    const auto known = std::ranges::find(names_, name, &Expression::Name::text);
    Node node{.operation = Operation::name};
    node.name = static_cast<std::size_t>(known - names_.begin());
    if (known == names_.end()) names_.push_back({std::string(name), first + 1});
    return node;
  }

  /// Reads the arguments of a function and the ")" after them.
  Node call(std::string_view name, std::size_t first) {
    Node node{.operation = Operation::function};
    node.function = expression_function(name);
    if (node.function == nullptr)
      fail_at(first, fmt::format("there is no function '{}'; there are {}", name, names_of_functions()));
    arguments(node.parts);
    const std::size_t least = node.function->least, most = node.function->most, count = node.parts.size();
    if (count < least || count > most)
      fail_at(first, fmt::format("{} takes {}{} number{}, not {}", name, least, most > least ? " or more" : "",
                                 most > 1 ? "s" : "", count));
    return node;
  }

  Node literal() {
    Node node;
    const char *first = text_.data() + at_, *last = text_.data() + text_.size();
    const auto [end, error] = std::from_chars(first, last, node.number);
    if (error == std::errc::result_out_of_range)
      fail_at(at_, fmt::format("{} is outside of the range of float64", std::string_view(first, end)));
    if (error != std::errc() || (end != last && continues_name(*end))) unexpected("an attribute or a number");
    std::uint64_t whole = 0;
    const auto [whole_end, whole_error] = std::from_chars(first, last, whole);
    if (whole_error == std::errc() && whole_end == end) node.whole = whole;
    canonical_.append(first, end);
    at_ += static_cast<std::size_t>(end - first);
    return node;
  }

  Node condition(Node node, std::size_t at) const {
    if (!node.is_condition()) fail_at(at, "a comparison is expected, such as z < 100");
    return node;
  }
  Node number(Node node, std::size_t at) const {
    if (node.is_condition()) fail_at(at, "an attribute or a number is expected, not a comparison");
    return node;
  }

  /// Limits the depth of recursion.
  struct Depth {
    explicit Depth(ExpressionParser& of) : parser(of) {
      if (++parser.depth_ > kMostDepth)
        parser.fail_at(parser.at_, "there are more than 100 signs ! - ( inside each other");
    }
    ~Depth() { --parser.depth_; }
    Depth(const Depth&) = delete;
    Depth& operator=(const Depth&) = delete;
    ExpressionParser& parser;
  };
  static constexpr int kMostDepth = 200;  // a parenthesis takes two levels
  std::vector<Expression::Name>& names_;
  int depth_ = 0;
};

}  // namespace

bool continues_name(char c) { return begins_name(c) || is_digit(c) || c == '.'; }

std::string spelled_name(std::string_view name) {
  const bool is_plain = !name.empty() && begins_name(name[0]) && std::ranges::all_of(name, continues_name);
  const bool is_word = in_lower_case(name) == "not" || in_lower_case(name) == "where";
  return is_plain && !is_word ? std::string(name) : fmt::format("`{}`", name);
}

std::string_view name_in(std::string_view text) {
  text = without_outer_blanks(text);
  if (text.size() > 2 && text[0] == '`' && text.find('`', 1) == text.size() - 1) return text.substr(1, text.size() - 2);
  return std::ranges::all_of(text, continues_name) ? text : std::string_view();
}

std::string with_hidden_names(std::string_view text) {
  std::string hidden(text);
  for (std::size_t first = text.find('`'); first != text.npos;) {
    const std::size_t last = text.find('`', first + 1);
    if (last == text.npos) break;
    std::fill(hidden.begin() + static_cast<std::ptrdiff_t>(first), hidden.begin() + static_cast<std::ptrdiff_t>(last),
              '`');
    first = text.find('`', last + 1);
  }
  return hidden;
}

std::string_view without_outer_blanks(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

Expression::Expression(std::string_view text, std::string_view where, Form form) : text_(without_outer_blanks(text)) {
  if (text_.empty() && form == Form::number)
    fail_usage("{}: a number is missing; write one such as intensity * 2.", where);
  if (text_.empty()) fail_usage("{}: the condition is empty; write one such as classification == 2 && z < 100.", where);
  ExpressionParser parser(text_, where, names_);
  root_ = std::make_shared<const Node>(parser.whole_text(form));
  canonical_ = std::move(parser).canonical();
}

bool Expression::is_name() const {
  return names_.size() == 1 && (canonical_ == names_[0].text || canonical_ == spelled_name(names_[0].text));
}

}  // namespace pointsweep
