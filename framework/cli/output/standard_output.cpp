// SPDX-License-Identifier: Apache-2.0
#include "cli/output/standard_output.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <weft/core/whole_file.hpp>

#include "cli/output/outcome.hpp"

namespace weft::cli {

void guard_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // The lowest number is free, because those below are open.
    if (fcntl(stream, F_GETFD) < 0) static_cast<void>(open("/dev/null", O_RDONLY));
  }
  for (const int signal : {SIGXFSZ, SIGPIPE}) std::signal(signal, SIG_IGN);
}

namespace {

/// Such as of `weft records | head`: that is no failure to talk about.
bool has_no_reader() {
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  return poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

}  // namespace

bool standard_output_failed() {
  errno = 0;
  // This includes the output of std::cout.
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0) return false;
  const std::error_code code(errno, std::generic_category());
  if (has_no_reader()) return true;
  print_error({Errc::io,
               "the standard output cannot be written" +
                   (code ? " (" + why_not_written(code) + ")" : std::string()),
               {}});
  return true;
}

}  // namespace weft::cli
