// SPDX-License-Identifier: MIT
#include "cli/console/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "pointsweep/program/formats.h"
#include "pointsweep/program/process.h"
#include "pointsweep/url.h"

namespace pointsweep {
namespace {

/// Returns a text like "GCC 12.2.0".
std::string compiler() {
#if defined(__clang__)
  return fmt::format("Clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  return fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "unknown compiler";
#endif
}

std::string line_as_typed;

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

std::string version_number() { return POINTSWEEP_VERSION; }

std::string version_text() {
  constexpr std::string_view kBuildType = POINTSWEEP_BUILD_TYPE;
  std::string text = "pointsweep " POINTSWEEP_VERSION "\n";
  if (!commit_of_build().empty()) text += fmt::format("  {:<16}{}\n", "commit", commit_of_build());
  text += fmt::format("  {:<16}{}, {}\n", "build", compiler(), kBuildType.empty() ? "no build type" : kBuildType);
  text += fmt::format("  {:<16}{}\n", "instruction set", instruction_set_in_use());
  text += fmt::format("  {:<16}{}\n", "reads", readable_formats());
  std::string written;
  for (const std::string_view extension : writable_extensions()) written += fmt::format("{}, ", extension);
  text += fmt::format("  {:<16}{}{}\n", "writes", written, array_extension());
  text += fmt::format("  {:<16}{}\n", "codecs", codecs());
  return text + fmt::format("  {:<16}{}", "URLs", reads_urls() ? "http, https, s3, gs, az" : "none");
}

void keep_command_line(int argc, const char* const* argv) {
  line_as_typed = "pointsweep";
  for (int i = 1; i < argc; ++i) line_as_typed += " " + quoted(argv[i]);
}

const std::string& command_line() { return line_as_typed; }

}  // namespace pointsweep
