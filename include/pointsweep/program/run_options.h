// SPDX-License-Identifier: MIT
/// The options of runs, declared once. The flags of the tool, the options of the Python package, the records of runs
/// and the identity of a resumable run take names, values and meanings from here.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/export.h"
#include "pointsweep/run.h"

namespace pointsweep {

struct RunOption {
  /// The group of the flag in the help.
  enum class Group : std::uint8_t { output, machine, other };
  enum class Effect : std::uint8_t {
    values,  ///< the option is in the record of a run, since it decides values in the output
    file,    ///< the output depends on the option, but no record states it
    none,    ///< the option has no effect on outputs
  };

  std::string name;     ///< name in Python, in records and in the identity of a run, e.g. "temp_folder"
  std::string flag;     ///< flag of the tool, e.g. "--temp-dir"
  std::string value;    ///< placeholder of the value in the help, e.g. "DIR"; empty for a switch, which has no value
  std::string meaning;  ///< sentence in the help
  Group group = Group::output;
  Effect effect = Effect::values;
  std::vector<std::string> words = {};  ///< all possible values, if they are words
  /// Sets the option from a text. Throws UsageError, beginning with `where`, for a text that is no value.
  std::function<void(RunOptions&, const std::string& text, const std::string& where)> set = {};
  std::function<std::string(const RunOptions&)> text = {};  ///< returns the value as a text, "" for the default
};

POINTSWEEP_EXPORT const std::vector<RunOption>& run_options();

/// Returns the declaration of the option `name`, which must exist.
POINTSWEEP_EXPORT const RunOption& run_option(std::string_view name);

/// The text that switches an option without a value on.
inline constexpr const char* kSwitchedOn = "yes";

/// Returns the identity of the options on which outputs depend: a line "name value" for each.
POINTSWEEP_EXPORT std::string identity_text(const RunOptions& options);

}  // namespace pointsweep
