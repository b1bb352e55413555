// SPDX-License-Identifier: MIT
/// Manual pages in roff.
#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "cli/console/program.h"
#include "cli/text/declared_options.h"
#include "cli/text/help.h"

namespace pointsweep {
namespace {

/// Escapes a line of text so that roff takes no part of it as a request.
std::string roff(std::string_view text) {
  std::string out;
  if (text.starts_with('.') || text.starts_with('\'')) out += "\\&";
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else
      out += c;
  }
  return out;
}

std::string bold(std::string_view text) { return fmt::format("\\fB{}\\fR", roff(text)); }
std::string italic(std::string_view text) { return fmt::format("\\fI{}\\fR", roff(text)); }

std::string upper_case(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

std::string page_head(const std::string& name, const std::string& meaning) {
  return fmt::format(".TH {} 1 \"\" \"pointsweep {}\" \"pointsweep\"\n.SH NAME\n{} \\- {}\n", upper_case(name),
                     version_number(), roff(name), roff(meaning));
}

/// Returns the names and the value of an option: "-q, --quiet", "--order input|sweep".
std::string option_title(const DeclaredOption& option) {
  std::string title;
  for (const std::string& flag : option.flags) title += (title.empty() ? "" : ", ") + bold(flag);
  if (option.value.empty()) return title;
  return title + (title.empty() ? "" : " ") + italic(option.value);
}

std::string option_list(const char* section, const std::vector<DeclaredOption>& options) {
  std::string text = options.empty() ? "" : fmt::format(".SH {}\n", section);
  for (const DeclaredOption& option : options)
    text += fmt::format(".TP\n{}\n{}.\n", option_title(option), roff(option.meaning));
  return text;
}

/// Returns the footer of a help as a section. Lines that begin with a blank (examples, tables) stay separate lines;
/// the other lines form paragraphs.
std::string notes(const std::string& footer, const char* section) {
  std::istringstream in(footer);
  std::string text, line;
  bool verbatim = false;
  while (std::getline(in, line)) {
    const bool kept = line.starts_with(' ');
    if (kept != verbatim) text += kept ? ".PP\n.nf\n" : ".fi\n";
    verbatim = kept;
    text += line.empty() ? ".PP\n" : roff(line) + "\n";
  }
  if (verbatim) text += ".fi\n";
  while (text.starts_with(".PP\n")) text.erase(0, 4);
  return text.empty() ? "" : fmt::format(".SH {}\n{}", section, text);
}

/// Returns the text without a ".PP" before a request that begins a paragraph itself.
std::string without_empty_paragraphs(std::string text) {
  for (const char* twice : {".PP\n.PP\n", ".PP\n.SH"})
    for (std::size_t at = 0; (at = text.find(twice, at)) != text.npos;) text.erase(at, 4);
  return text;
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n0: success; 1: an error of a file or of the machine; 2: an error of the command line; 3: "
    "verify could not check everything; 128 + N: stopped by signal N.\n";

}  // namespace

std::string man_page_of_tool(const CLI::App& app) {
  std::string text = page_head("pointsweep", "local attributes of point clouds of any size");
  text += ".SH SYNOPSIS\n" + bold("pointsweep") + " " + italic("VERB") + " [" + italic("OPTIONS") + "] " +
          italic("FILES") + "\n.SH DESCRIPTION\n" + roff(app.get_description()) + "\n.SH VERBS\n";
  for (const DeclaredVerb& verb : declared_verbs(app))
    text += fmt::format(".TP\n{}(1)\n{}.\n", bold("pointsweep-" + verb.name), roff(verb.meaning));
  text += option_list("OPTIONS", options_of_tool(app));
  return without_empty_paragraphs(text + notes(app.get_footer(), "NOTES"));
}

std::string man_page_of_verb(const CLI::App& app, std::string_view name) {
  const std::vector<DeclaredVerb> verbs = declared_verbs(app);
  const auto verb = std::ranges::find(verbs, name, &DeclaredVerb::name);
  if (verb == verbs.end()) return "";
  std::string text = page_head("pointsweep-" + verb->name, verb->meaning);
  text += ".SH SYNOPSIS\n" + bold("pointsweep " + verb->name) +
          roff(verb->usage.substr(verb->usage.find(verb->name) + verb->name.size())) + "\n";
  text += option_list("ARGUMENTS", verb->arguments) + option_list("OPTIONS", verb->options);
  text += notes(verb->footer, "NOTES") + kExitStatus + ".SH SEE ALSO\n" + bold("pointsweep") + "(1)\n";
  return without_empty_paragraphs(text);
}

}  // namespace pointsweep
