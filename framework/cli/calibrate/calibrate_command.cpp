// SPDX-License-Identifier: Apache-2.0
// `weft calibrate` is a separate program, which links OpenCV; this file executes it.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output/program_root.hpp"

namespace weft::cli {
namespace {

/// Replaces this process by weft-calibrate from the same folder; returns only on failure.
Error hand_over(std::vector<std::string> words) {
  std::string program = (program_root() / "bin/weft-calibrate").string();
  std::vector<char*> arguments{program.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::fflush(nullptr);
  execv(program.c_str(), arguments.data());
  if (errno == ENOENT) {
    return {Errc::not_found,
            "is not there: this Weft was built without OpenCV's module aruco; install "
            "libopencv-contrib-dev and build again, or install the package weft-plugins",
            program};
  }
  return {Errc::io, std::string("cannot be started: ") + std::strerror(errno), program};
}

}  // namespace

void add_calibrate_command(CLI::App& app, Context& context) {
  CLI::App* command =
      app.add_subcommand("calibrate", "Print a board, and make a camera file from images of it");
  command->prefix_command();
  command->fallthrough(false);
  command->set_help_flag();
  command->callback([&context, command] {
    print_error(hand_over(command->remaining()));
    context.exit_code = kInputOutput;
  });
}

}  // namespace weft::cli
