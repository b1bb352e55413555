// SPDX-License-Identifier: MIT
#include "cli/console/version.h"

#include <fmt/format.h>

#include <string_view>

#include "cli/console/commit.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/math/instruction_set_in_use.h"

namespace pointsweep {
namespace {

/// "GCC 12.2.0"
std::string compiler() {
#if defined(__clang__)
  return fmt::format("Clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  return fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "unknown compiler";
#endif
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
  text += fmt::format("  {:<16}{}{}\n", "writes", written, array_format().extensions.front());
  return text + fmt::format("  {:<16}{}", "codecs", codecs());
}

}  // namespace pointsweep
