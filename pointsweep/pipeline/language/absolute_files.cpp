// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/absolute_files.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

bool may_be_file(const OptionDeclaration& option) {
  return option.kind == OptionKind::file || option.kind == OptionKind::matrix;
}

/// Returns the declaration of an option; null if there is none.
const OptionDeclaration* declared_option(const OperatorDeclaration& op, const OptionText& option) {
  const auto found = std::ranges::find_if(op.options, [&](const OptionDeclaration& declared) {
    return option.name.empty() ? declared.positional : declared.name == option.name;
  });
  return found == op.options.end() ? nullptr : &*found;
}

/// Returns the folder before the first wildcard of a name; the name itself if it has no wildcard.
std::filesystem::path before_wildcards(const std::string& name) {
  const std::size_t wildcard = name.find_first_of("*?[");
  if (wildcard == std::string::npos) return name;
  const std::filesystem::path before(name.substr(0, wildcard));
  return before.has_parent_path() ? before.parent_path() : ".";
}

bool is_there(const std::string& name) {
  std::error_code none;
  return std::filesystem::exists(name, none) ||
         (before_wildcards(name) != name && std::filesystem::exists(before_wildcards(name), none));
}

}  // namespace

std::string with_absolute_files(std::string_view pipeline) {
  std::vector<StageText> stages = parse_pipeline(pipeline);
  for (StageText& stage : stages) {
    const OperatorDeclaration* const op = declaration_of(stage.name);
    if (op == nullptr) continue;
    for (OptionText& option : stage.options) {
      const OptionDeclaration* const declared = declared_option(*op, option);
      if (declared != nullptr && may_be_file(*declared) && is_there(option.value))
        option.value = std::filesystem::absolute(option.value).lexically_normal().string();
    }
  }
  return to_text(stages);
}

}  // namespace pointsweep
