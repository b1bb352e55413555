// SPDX-License-Identifier: MIT
/// Scripts that complete commands in bash, zsh and fish.
#include <fmt/format.h>

#include "cli/text/declared_options.h"

namespace pointsweep {
namespace {

/// Texts by which the script of a shell offers values, one for each Offer. {} stands for DeclaredOption::words.
struct OfferTexts {
  const char *words, *files, *folders, *pipeline, *nothing;

  std::string of(const DeclaredOption& option) const {
    const char* text = option.offer == Offer::words      ? words
                       : option.offer == Offer::files    ? files
                       : option.offer == Offer::folders  ? folders
                       : option.offer == Offer::pipeline ? pipeline
                                                         : nothing;
    return fmt::format(fmt::runtime(text), fmt::join(option.words, " "));
  }
};

/// kBashTail handles the marks that begin with @.
constexpr OfferTexts kBash{"{}", "@files", "@folders", "@pipeline", "@nothing"};
constexpr OfferTexts kZsh{"({})", "_files", "_files -/",
                          "_alternative \"operators:operator:({})\" \"files:file:_files\"", " "};
/// Arguments of fish's command `complete`.
constexpr OfferTexts kFish{" -x -a '{}'", " -r -F", " -x -a '(__fish_complete_directories)'", " -r -F -a '{}'", " -x"};

std::string bash_case(const DeclaredVerb& verb) {
  std::string flags, values;
  for (const DeclaredOption& option : verb.options) {
    flags += fmt::format("{}{}", flags.empty() ? "" : " ", fmt::join(option.flags, " "));
    if (!option.value.empty())
      values += fmt::format("        {}) values='{}' ;;\n", fmt::join(option.flags, "|"), kBash.of(option));
  }
  const std::string first = verb.arguments.empty() ? "" : kBash.of(verb.arguments.front());
  const std::string rest = verb.arguments.empty() ? "" : kBash.of(verb.arguments.back());
  std::string text = fmt::format("    {})\n      options='{}'\n      argument='{}'\n", verb.name, flags, rest);
  if (first != rest) text += fmt::format("      ((COMP_CWORD == 2)) && argument='{}'\n", first);
  if (!values.empty()) text += fmt::format("      case $prev in\n{}      esac\n", values);
  return text + "      ;;\n";
}

constexpr const char* kBashHead =
    "# bash completion of pointsweep; made by 'pointsweep completion bash'\n"
    "_pointsweep() {\n"
    "  local cur=$2 prev=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]} options= argument= values=\n"
    "  [[ $cur == '=' ]] && cur=\n"
    "  [[ $prev == '=' ]] && prev=${COMP_WORDS[COMP_CWORD-2]}\n"
    "  COMPREPLY=()\n";

constexpr const char* kBashTail =
    "  if [[ -z $values ]]; then\n"
    "    [[ $cur == -* ]] && values=$options || values=$argument\n"
    "  fi\n"
    "  case $values in\n"
    "    @nothing) ;;\n"
    "    @files)\n"
    "      compopt -o filenames 2>/dev/null\n"
    "      mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")\n"
    "      ;;\n"
    "    @folders)\n"
    "      compopt -o filenames 2>/dev/null\n"
    "      mapfile -t COMPREPLY < <(compgen -d -- \"$cur\")\n"
    "      ;;\n"
    "    @pipeline)\n"
    "      local begun=${cur##*[| ]}\n"
    "      compopt -o nospace 2>/dev/null\n"
    "      mapfile -t COMPREPLY < <(compgen -P \"${cur%\"$begun\"}\" -W \"$operators\" -- \"$begun\"; compgen -f -- "
    "\"$cur\")\n"
    "      ;;\n"
    "    *) mapfile -t COMPREPLY < <(compgen -W \"$values\" -- \"$cur\") ;;\n"
    "  esac\n"
    "}\n"
    "complete -F _pointsweep pointsweep\n";

/// Returns the text in single quotes. `escaped_quote`: the way in which the shell (zsh or fish) writes a quote inside
/// such a text.
std::string quoted(const std::string& text, const char* escaped_quote) {
  std::string out = "'";
  for (const char c : text) c == '\'' ? void(out += escaped_quote) : out.push_back(c);
  return out + "'";
}

/// Escapes the text for a specification of _arguments, in which colons and brackets have a meaning.
std::string zsh_part(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_option(const DeclaredOption& option) {
  std::string lines;
  for (const std::string& flag : option.flags) {
    std::string spec =
        fmt::format("({}){}[{}]", fmt::join(option.flags, " "), flag, zsh_part(first_clause(option.meaning)));
    if (!option.value.empty()) spec += ":" + zsh_part(option.value) + ":" + kZsh.of(option);
    lines += " \\\n        " + quoted(spec, "'\\''");
  }
  return lines;
}

std::string zsh_case(const DeclaredVerb& verb) {
  std::string text = fmt::format("    {})\n      _arguments -S", verb.name);
  for (const DeclaredOption& option : verb.options) text += zsh_option(option);
  for (std::size_t a = 0; a < verb.arguments.size(); ++a) {
    const bool last = a + 1 == verb.arguments.size();
    const DeclaredOption& argument = verb.arguments[a];
    const std::string place = last ? "*" : std::to_string(a + 1);
    text += " \\\n        " + quoted(place + ":" + zsh_part(argument.value) + ":" + kZsh.of(argument), "'\\''");
  }
  return text + "\n      ;;\n";
}

std::string fish_option(const DeclaredOption& option, const std::string& condition) {
  std::string line = "complete -c pointsweep -n " + condition;
  for (const std::string& flag : option.flags)
    line += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
  if (!option.value.empty()) line += kFish.of(option);
  return line + " -d " + quoted(first_clause(option.meaning), "\\'") + "\n";
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
  std::string verbs, operators, cases, own;
  for (const DeclaredVerb& verb : declared_verbs(app)) {
    verbs += verb.name + " ";
    cases += bash_case(verb);
    for (const DeclaredOption& option : verb.options)
      if (option.offer == Offer::pipeline) operators = fmt::format("{}", fmt::join(option.words, " "));
  }
  for (const DeclaredOption& option : options_of_tool(app)) own += fmt::format("{} ", fmt::join(option.flags, " "));
  own.pop_back();
  return fmt::format(
      "{}  local operators='{}'\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    values='{}{}'\n"
      "  else\n"
      "    case $verb in\n{}    esac\n"
      "  fi\n{}",
      kBashHead, operators, verbs, own, cases, kBashTail);
}

std::string zsh_completion(const CLI::App& app) {
  std::string verbs, cases, own;
  for (const DeclaredVerb& verb : declared_verbs(app)) {
    verbs += "    " + quoted(verb.name + ":" + zsh_part(first_clause(verb.meaning)), "'\\''") + "\n";
    cases += zsh_case(verb);
  }
  for (const DeclaredOption& option : options_of_tool(app)) own += zsh_option(option);
  return fmt::format(
      "#compdef pointsweep\n"
      "# zsh completion of pointsweep; made by 'pointsweep completion zsh'\n"
      "_pointsweep() {{\n"
      "  local -a verbs=(\n{}  )\n"
      "  if ((CURRENT == 2)); then\n"
      "    _describe verb verbs\n"
      "    _arguments -S{}\n"
      "    return\n"
      "  fi\n"
      "  shift words\n"
      "  ((CURRENT--))\n"
      "  case $words[1] in\n{}  esac\n"
      "}}\n"
      "if [[ $funcstack[1] == _pointsweep ]]; then\n"
      "  _pointsweep \"$@\"\n"
      "else\n"
      "  compdef _pointsweep pointsweep\n"
      "fi\n",
      verbs, own, cases);
}

std::string fish_completion(const CLI::App& app) {
  std::string text =
      "# fish completion of pointsweep; made by 'pointsweep completion fish'\n"
      "complete -c pointsweep -f\n";
  for (const DeclaredOption& option : options_of_tool(app)) text += fish_option(option, "__fish_use_subcommand");
  for (const DeclaredVerb& verb : declared_verbs(app)) {
    text += fmt::format("complete -c pointsweep -n __fish_use_subcommand -a {} -d {}\n", verb.name,
                        quoted(first_clause(verb.meaning), "\\'"));
    const std::string condition = fmt::format("'__fish_seen_subcommand_from {}'", verb.name);
    for (const DeclaredOption& option : verb.options) text += fish_option(option, condition);
    for (const DeclaredOption& argument : verb.arguments) {
      const std::string values = argument.offer == Offer::files ? " -F" : kFish.of(argument);
      text += fmt::format("complete -c pointsweep -n {}{}\n", condition, values);
    }
  }
  return text;
}

}  // namespace pointsweep
