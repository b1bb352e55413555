// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/output_warnings.h"

#include <fmt/format.h>

namespace pointsweep {

void OutputWarnings::add(const std::vector<std::string>& warnings, const std::filesystem::path& output) {
  for (const std::string& warning : warnings) {
    const std::string name = output.string();
    const std::string what = warning.starts_with(name) ? warning.substr(name.size()) : warning;
    const auto [known, is_new] = warnings_.try_emplace(what, Warning{warning});
    if (!is_new) ++known->second.others;
  }
}

std::vector<std::string> OutputWarnings::sentences() const {
  std::vector<std::string> all;
  for (const auto& [what, warning] : warnings_)
    all.push_back(warning.others == 0 ? warning.first
                                      : fmt::format("{} (The same holds for {} more {}.)", warning.first,
                                                    warning.others, warning.others == 1 ? "output" : "outputs"));
  return all;
}

}  // namespace pointsweep
