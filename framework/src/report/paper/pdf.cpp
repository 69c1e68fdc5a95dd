// SPDX-License-Identifier: Apache-2.0
#include "report/paper/pdf.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <vector>

namespace weft::evaluation {
namespace {

constexpr const char* kConverter = "rsvg-convert";

/// The exit status of a program that prints nothing, as waitpid gives it; nothing where there is no
/// such program.
std::optional<int> run_quietly(const std::vector<std::string>& command) {
  std::vector<char*> arguments, environment;
  for (const std::string& each : command) arguments.push_back(const_cast<char*>(each.c_str()));
  arguments.push_back(nullptr);
  for (char** each = environ; *each != nullptr; ++each) environment.push_back(*each);
  std::string no_date = "SOURCE_DATE_EPOCH=0";  // else the file holds the time of its making
  environment.push_back(no_date.data());
  environment.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  }
  pid_t id = 0;
  const int failed =
      posix_spawnp(&id, arguments.front(), &actions, nullptr, arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return std::nullopt;
  int status = 0;
  while (waitpid(id, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return status;
}

}  // namespace

Result<std::optional<std::string>> write_pdf(const std::string& svg) {
  const std::string pdf = std::filesystem::path(svg).replace_extension(".pdf").string();
  const auto status = run_quietly({kConverter, "--format=pdf", "--output=" + pdf, svg});
  if (!status) return std::optional<std::string>();
  if (*status == 0) return std::optional(pdf);
  return Error{Errc::io,
               std::string(kConverter) +
                   " did not make a PDF of it; is the disk full? Without that program figures are "
                   "SVG alone",
               svg};
}

}  // namespace weft::evaluation
