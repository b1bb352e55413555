// SPDX-License-Identifier: MIT
#include "cli/text/help.h"

#include <sstream>

namespace pointsweep {
namespace {

constexpr std::size_t kLeftColumns = 30;  // column at which the meanings begin, to the right of the names

/// Returns the number of characters of a text in UTF-8, in which a character may take several bytes.
std::size_t columns_of(std::string_view text) {
  std::size_t columns = 0;
  for (const char c : text) columns += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  return columns;
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t indent, std::size_t columns) {
  std::istringstream words{std::string(text)};
  std::string out;
  std::size_t at = indent;
  for (std::string word; words >> word;) {
    const bool first = out.empty();
    if (!first && at + 1 + columns_of(word) > columns) {
      out += "\n" + std::string(indent, ' ');
      at = indent;
    } else if (!first) {
      out += ' ', ++at;
    }
    out += word, at += columns_of(word);
  }
  return out;
}

std::string capitalized(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

HelpFormatter::HelpFormatter() {
  column_width(kLeftColumns);
  label("SUBCOMMAND", "VERB");
}

std::string HelpFormatter::row(const std::string& left, const std::string& right) const {
  std::string text = "  " + left;
  if (right.empty()) return text + "\n";
  if (text.size() + 2 > kLeftColumns) text += "\n", text += std::string(kLeftColumns, ' ');
  text.resize(std::max(text.size(), kLeftColumns), ' ');
  return text + wrapped(right, kLeftColumns) + "\n";
}

std::string HelpFormatter::make_description(const CLI::App* app) const {
  return wrapped(app->get_description(), 0) + "\n\n";
}

std::string HelpFormatter::options_in_groups(const CLI::App* app) const {
  std::string text;
  for (const char* group : kGroups) {
    const auto options = app->get_options(
        [&](const CLI::Option* option) { return option->get_group() == group && option->nonpositional(); });
    if (!options.empty()) text += make_group(group, false, options);
  }
  return text;
}

std::string HelpFormatter::make_option(const CLI::Option* option, bool positional) const {
  return row(make_option_name(option, positional) + make_option_opts(option), make_option_desc(option));
}

std::string HelpFormatter::make_option_name(const CLI::Option* option, bool positional) const {
  std::string name = option->get_name(positional, !positional);
  if (name == kInputsAndOutput) return "IN... OUT";
  if (const std::size_t comma = name.find(','); comma != name.npos) name.insert(comma + 1, " ");
  return name;
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  return option->get_type_name().empty() ? "" : " " + option->get_type_name();
}

std::string HelpFormatter::make_option_usage(const CLI::Option* option) const {
  const std::string name = make_option_name(option, true);
  const bool several = option->get_name(true) != kInputsAndOutput && option->get_expected_max() > 1;
  const bool optional = !option->get_required() && option->get_name(true) != kInputsAndOutput;
  return (optional ? "[" : "") + name + (several ? "..." : "") + (optional ? "]" : "");
}

/// Joins the parts of the help. Removes repeated empty lines, since the parts may end with one and begin with another.
std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) +
                     options_in_groups(app) + make_subcommands(app, mode) + "\n" + make_footer(app);
  while (text.ends_with("\n\n")) text.pop_back();
  for (std::size_t at = 0; (at = text.find("\n\n\n", at)) != text.npos;) text.erase(at, 1);
  return text;
}

std::string HelpFormatter::make_subcommand(const CLI::App* verb) const {
  return row(verb->get_name(), verb->get_description());
}

std::string HelpFormatter::make_footer(const CLI::App* app) const {
  std::istringstream footer(app->get_footer());
  std::string text, paragraph;
  const auto end_paragraph = [&] {
    if (!paragraph.empty()) text += wrapped(paragraph, 0) + "\n";
    paragraph.clear();
  };
  for (std::string line; std::getline(footer, line);) {
    const bool is_kept = line.empty() || line.starts_with(' ');
    if (is_kept) end_paragraph();
    is_kept ? text += line + "\n" : paragraph += line + " ";
  }
  end_paragraph();
  return text;
}

}  // namespace pointsweep
