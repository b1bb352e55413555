// SPDX-License-Identifier: MIT
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/points/lower_case.h"
#include "pointsweep/points/text_file.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::size_t kMostBytes = 1 << 20;  // bytes of the largest file that is accepted as a pipeline

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '-';
}

/// Returns whether `c` may stand in a value without quotes.
bool is_bare(char c) { return is_name_character(c) || c == '+' || c == '%' || c == ':' || c == '/'; }

/// Returns the index of the first word `in` or `between` after an operand of a condition; npos if there is none.
std::size_t place_of_word(std::string_view option) {
  for (std::size_t at = 0, end = 0; at < option.size(); at = end) {
    end = at + 1;
    if (!is_name_character(option[at])) continue;
    while (end < option.size() && is_name_character(option[end])) ++end;
    const std::string word = in_lower_case(option.substr(at, end - at));
    const std::size_t before = at == 0 ? option.npos : option.find_last_not_of(kSpace, at - 1);
    const bool has_operand = before != option.npos && (option[before] == ')' || is_name_character(option[before]));
    if (has_operand && (word == "in" || word == "between")) return at;
  }
  return option.npos;
}

/// Parses by recursive descent. The grammar is
///   pipeline = stage {"|" stage}            stage = name ["(" [option {"," option}] ")"]
///   option = [name "="] (value | condition | assignment)  value = bare | quoted | "[" bare {"," bare} "]"
/// A condition (operators/expressions/expression.h) contains a sign, or the word `in` or `between` after an operand,
/// that no unquoted value contains. It ends before a "," or ")" that is neither within parentheses of the condition nor
/// within a name between backquotes; so do the assignments of the stage `set`. The parser accepts every option without
/// a name; read_options() refuses it if the operator needs the name.
class Parser {
 public:
  Parser(std::string_view text, std::string_view source) : text_(text), source_(source) {}

  std::vector<StageText> pipeline() {
    std::vector<StageText> stages;
    do {
      stages.push_back(stage());
    } while (take('|'));
    if (at_ < text_.size()) expected("'|' or the end");
    return stages;
  }

 private:
  StageText stage() {
    skip_space();
    StageText stage{{}, {}, place()};
    stage.name = name("the name of an operator");
    if (!take('(') || take(')')) return stage;
    do {
      stage.options.push_back(stage.name == "set" ? assignment() : option());
    } while (take(','));
    if (!take(')')) expected("',' or ')'");
    return stage;
  }

  OptionText option() {
    skip_space();
    OptionText option{{}, {}, place()};
    option.name = name_before_equal_sign();
    option.value = value(option.name.empty() ? "the name of an option" : "a value");
    return option;
  }

  /// Parses NAME = at the start of an option and returns the name. If the option starts otherwise, returns an empty
  /// name and parses nothing.
  std::string name_before_equal_sign() {
    std::size_t end = at_;
    while (end < text_.size() && is_name_character(text_[end])) ++end;
    const std::size_t sign = std::min(text_.find_first_not_of(kSpace, end), text_.size());
    if (end == at_ || !text_.substr(sign).starts_with('=') || text_.substr(sign).starts_with("==")) return {};
    const std::size_t first = std::exchange(at_, sign + 1);
    return std::string(text_.substr(first, end - first));
  }

  /// Parses an assignment of the stage `set`, NAME = EXPRESSION [where CONDITION], or another option of this stage.
  OptionText assignment() {
    skip_space();
    const std::string_view text = text_.substr(at_, end_of_option() - at_);
    const std::string_view name = text.substr(0, text.find_first_of("= \t\r\n"));
    const bool is_quoted = text.starts_with('"') || text.starts_with('\'');
    if (is_quoted || name == "as" || name == "assign") return option();
    OptionText assigned{{}, {}, place()};
    assigned.value = condition();
    if (assigned.value.empty()) expected("an assignment such as classification = 7");
    return assigned;
  }

  /// Returns the end of the option that begins at at_; does not handle quoted options.
  std::size_t end_of_option() const {
    int open = 0;
    for (std::size_t i = at_; i < text_.size(); ++i) {
      if (const std::size_t last = text_[i] == '`' ? text_.find('`', i + 1) : text_.npos; last != text_.npos) i = last;
      if (text_[i] == '(') ++open;
      if (text_[i] == ')' && open-- == 0) return i;
      if (text_[i] == ',' && open == 0) return i;
    }
    return text_.size();
  }

  /// Returns whether a condition begins at at_. A condition has a sign or word that no other option has.
  bool is_condition() const {
    if (at_ >= text_.size() || text_[at_] == '"' || text_[at_] == '\'' || text_[at_] == '[') return false;
    const std::string_view option = text_.substr(at_, end_of_option() - at_);
    const std::size_t sign = std::min({option.find("=="), option.find_first_of("<>!&`"), place_of_word(option)});
    return sign != option.npos && sign < option.find_first_of("\"'[");
  }

  std::string condition() {
    const std::size_t end = end_of_option();
    const std::string_view text = text_.substr(at_, end - at_);
    at_ = end;
    return std::string(text.substr(0, text.find_last_not_of(kSpace) + 1));
  }

  std::string value(std::string_view what) {
    skip_space();
    if (is_condition()) return condition();
    if (at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'')) return quoted();
    if (!take('[')) return word(is_bare, what);
    std::string list = word(is_bare, "a value");
    while (take(',')) list += "," + word(is_bare, "a value");
    if (!take(']')) expected("',' or ']'");
    return list;
  }

  std::string quoted() {
    const std::string start = place();
    const char quote = text_[at_++];
    std::string value;
    for (; at_ < text_.size() && text_[at_] != quote; ++at_) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      value += text_[at_];
    }
    if (at_ >= text_.size()) fail_usage("{}: the quote that begins here does not end.", start);
    ++at_;
    return value;
  }

  std::string name(std::string_view what) { return word(is_name_character, what); }

  std::string word(bool (*belongs)(char), std::string_view what) {
    skip_space();
    const std::size_t start = at_;
    while (at_ < text_.size() && belongs(text_[at_])) ++at_;
    if (at_ == start) expected(what);
    return std::string(text_.substr(start, at_ - start));
  }

  bool take(char c) {
    skip_space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  void skip_space() { at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size()); }
  std::string place() const { return fmt::format("{}, column {}", source_, at_ + 1); }

  [[noreturn]] void expected(std::string_view what) const {
    if (at_ >= text_.size()) fail_usage("{}: {} is expected, but the text ends.", place(), what);
    fail_usage("{}: {} is expected, not '{}'; a pipeline looks like knn(k=8) | normals(orient=up).", place(), what,
               first_character(text_.substr(at_)));
  }

  std::string_view text_, source_;
  std::size_t at_ = 0;
};

bool is_list(std::string_view value) {
  if (value.find(',') == value.npos || value.starts_with(',') || value.ends_with(',')) return false;
  return value.find(",,") == value.npos &&
         std::all_of(value.begin(), value.end(), [](char c) { return c == ',' || is_bare(c); });
}

std::string value_text(const std::string& value) {
  if (!value.empty() && std::all_of(value.begin(), value.end(), is_bare)) return value;
  if (is_list(value)) return "[" + value + "]";
  std::string quoted = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMostBytes + 1, '\0');
  if (file) file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad() || !file.is_open()) fail("{}: the pipeline cannot be read; check the name and its permissions.", path);
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMostBytes) fail_usage("{}: is larger than 1 MB, so it is hardly a pipeline.", path);
  return std::string(without_byte_order_mark(text));
}

}  // namespace

bool is_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), is_name_character);
}

std::vector<StageText> parse_pipeline(std::string_view text, std::string_view source) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == text.npos) fail_usage("{}: is empty; write one such as knn(k=8) | normals.", source);
  if (text[first] == '[' || text[first] == '{') return parse_json_pipeline(text, source);
  return Parser(text, source).pipeline();
}

std::vector<StageText> parse_pipeline_or_file(const std::string& text_or_file) {
  const bool file = std::filesystem::path(text_or_file).extension() == ".json";
  std::error_code error;
  if (!file && std::filesystem::is_regular_file(text_or_file, error))
    fail_usage("{}: pipeline files end in .json; rename it, or write the stages themselves.", text_or_file);
  return file ? parse_json_pipeline(content_of(text_or_file), text_or_file) : parse_pipeline(text_or_file);
}

std::string to_text(const std::vector<StageText>& stages) {
  std::string text;
  for (const StageText& stage : stages) {
    text += (text.empty() ? "" : " | ") + stage.name;
    for (std::size_t i = 0; i < stage.options.size(); ++i) {
      const OptionText& option = stage.options[i];
      text += (i == 0 ? "(" : ", ") + (option.name.empty() ? "" : option.name + "=") + value_text(option.value);
    }
    if (!stage.options.empty()) text += ")";
  }
  return text;
}

}  // namespace pointsweep
