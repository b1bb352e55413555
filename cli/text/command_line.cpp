// SPDX-License-Identifier: MIT
#include "cli/text/command_line.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <utility>

namespace pointsweep {
namespace {

std::string line_as_typed, version_of_program;

bool is_safe(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("-_./,:=+@%").find(c) != std::string_view::npos;
}

std::string quoted(std::string_view word) {
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_safe)) return std::string(word);
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

void keep_command_line(int argc, const char* const* argv, std::string version) {
  version_of_program = std::move(version);
  line_as_typed = "pointsweep";
  for (int i = 1; i < argc; ++i) line_as_typed += " " + quoted(argv[i]);
}

const std::string& command_line() { return line_as_typed; }

const std::string& kept_version() { return version_of_program; }

}  // namespace pointsweep
