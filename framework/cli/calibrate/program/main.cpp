// SPDX-License-Identifier: Apache-2.0
// weft-calibrate: what `weft calibrate` runs.
#include <CLI/CLI.hpp>
#include <weft/core/version.hpp>

#include "cli/calibrate/program/program.hpp"
#include "cli/output/outcome.hpp"
#include "cli/output/standard_output.hpp"
#include "cli/shell/wrong_words.hpp"

namespace {

int run(int argc, char** argv) {
  CLI::App app{"Makes a camera file from images of a printed board.", "weft calibrate"};
  app.set_version_flag("--version", weft::kVersion);
  app.footer(
      "Exits with 0 on success and with 1 when the images do not determine the camera reliably. "
      "Exits with 2 on wrong usage, and with 3 when a file or the standard output cannot be read "
      "or written.");
  int exit_code = weft::cli::kDone;
  const auto calibrate = weft::cli::add_camera_options(app);
  weft::cli::add_board_command(app, exit_code);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) exit_code = calibrate();
  } catch (const CLI::Success& asked) {
    app.exit(asked);  // help or version
  } catch (const CLI::ParseError& error) {
    weft::cli::print_wrong_words(app, "weft calibrate", error);
    return weft::cli::kBadConfiguration;
  } catch (const std::exception& error) {
    if (std::ferror(stdout) != 0) return weft::cli::kInputOutput;  // reported at the end
    weft::cli::print_error({weft::Errc::io, error.what(), {}});
    return weft::cli::kInputOutput;
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  weft::cli::guard_standard_streams();
  const int exit_code = run(argc, argv);
  return weft::cli::standard_output_failed() ? weft::cli::kInputOutput : exit_code;
}
