// SPDX-License-Identifier: MIT
#include "cli/console/console.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

namespace pointsweep {
namespace {

int first_error = 0;

constexpr std::string_view kNames[] = {"error", "warning", "note"};

/// Opens /dev/null at the number of a closed descriptor. This relies on open(), which takes the lowest free number.
void take_place_of_closed(int descriptor) {
  if (::fcntl(descriptor, F_GETFD) < 0) ::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

}  // namespace

int write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written >= 0)
      text.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      return errno;
  }
  return 0;
}

void open_console() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) take_place_of_closed(descriptor);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void print(std::string_view text) {
  const int error = write_all(STDOUT_FILENO, text);
  const bool is_closed = error == EPIPE || error == EBADF;
  if (!is_closed && first_error == 0) first_error = error;
}

std::size_t text_columns() {
  constexpr std::size_t kNoTerminal = 80, kWidest = 100, kNarrowest = 60;
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kNoTerminal;
  return std::clamp<std::size_t>(size.ws_col, kNarrowest, kWidest);
}

int printing_error() { return first_error; }

std::string message_line(Severity severity, std::string_view sentence) {
  return fmt::format("{}: {}\n", kNames[static_cast<std::size_t>(severity)], sentence);
}

void report(Severity severity, std::string_view sentence) {
  write_all(STDERR_FILENO, message_line(severity, sentence));
}

}  // namespace pointsweep
