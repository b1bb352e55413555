// SPDX-License-Identifier: MIT
/// The options of runs whose values are words, declared once: the flags of the tool, the options of the Python package
/// and the records of runs take names and words from here.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/run.h"

namespace pointsweep {

struct RunWords {
  std::string name;                                       ///< of the flag and of the option in Python, e.g. "nonfinite"
  std::vector<std::string> words;                         ///< its values
  std::string meaning;                                    ///< the sentence in the help of the tool
  std::function<void(RunOptions&, std::size_t)> set;      ///< to the word of this index
  std::function<std::string(const RunOptions&)> current;  ///< the word; empty for the default
};

const std::vector<RunWords>& run_words();

/// The declaration of this name, which exists.
const RunWords& run_words(std::string_view name);

/// Throws UsageError, "--nonfinite: 'x' is not keep, drop or refuse.", for a word that the option does not have.
void set_word(RunOptions& options, std::string_view name, std::string_view word);

}  // namespace pointsweep
