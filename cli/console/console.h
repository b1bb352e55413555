// SPDX-License-Identifier: MIT
/// Output of the tool: texts on standard output, sentences on standard error; and errors of the command line. No
/// function of this file except refuse() throws an Error. A sentence that cannot be written has no effect on the exit
/// status of a verb; a text that cannot be written makes the verb fail (printing_error()), unless standard output is
/// closed or its reader has ended.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "pointsweep/error.h"

namespace pointsweep {

/// Prepares standard input, output and error at the start of main(). A closed stream gets a descriptor, so that no file
/// of a run takes its number; reading it, for standard input, or writing it, for the others, fails. A reader that has
/// ended, and a limit on the size of files, become errors of writing instead of signals.
void open_console();

/// Writes the whole text to a descriptor. Returns 0 or the errno of a failure.
int write_all(int descriptor, std::string_view text);

/// Writes a text to standard output. If standard output is closed, or its reader has ended, the text is dropped.
void print(std::string_view text);

/// Returns the width of lines on standard output in characters: the width of the terminal, limited to [60, 100]; 80
/// without a terminal.
std::size_t text_columns();

/// Returns the errno of the first failure of print() for another reason than a closed standard output or a reader that
/// has ended; 0 without such a failure.
int printing_error();

/// Severity of a sentence to the user. error: the run failed. warning: the result may not be what the user meant. note:
/// information about what was done.
enum class Severity : std::uint8_t { error, warning, note };

/// Returns the line that report() writes for a sentence: "warning: a.las: ..." and a line break.
std::string message_line(Severity severity, std::string_view sentence);

/// Writes a sentence to standard error. A failure is ignored.
void report(Severity severity, std::string_view sentence);

/// Throws UsageError with the formatted sentence.
template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> sentence, Args&&... args) {
  throw UsageError(fmt::format(sentence, std::forward<Args>(args)...));
}

}  // namespace pointsweep
