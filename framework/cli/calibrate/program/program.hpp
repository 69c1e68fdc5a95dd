// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/calibration/board.hpp"
#include "lab/calibration/calibrate.hpp"
#include "lab/calibration/view_collection.hpp"

namespace weft::cli {

/// `weft calibrate board`; its callback sets the exit code.
void add_board_command(CLI::App& app, int& exit_code);

/// The arguments of `weft calibrate` itself; returns what runs when there is no subcommand.
std::function<int()> add_camera_options(CLI::App& app);

/// --board, --squares, --square, --dictionary and --marker-share, of both.
struct BoardOptions {
  std::string pattern = "charuco", squares = "7x5", dictionary = "4x4_250";
  double square_m = 0.03, marker_share = 0.6;
};
void add_board_options(CLI::App& app, BoardOptions& options);
Result<calibration::Board> board_of(const BoardOptions& options);

/// 3 where a file cannot be read or written, 1 where views do not determine a camera, else 2.
int exit_code_of(const Error& error);

/// Text that `weft calibrate` prints for a camera.
std::string calibration_text(const calibration::Calibration& calibration);

/// Which parts of the image have corners, and what to show the camera next.
std::string coverage_text(const calibration::Coverage& coverage);

/// Frames in which the board was not found, with the reasons.
std::string without_text(const std::vector<calibration::NoView>& without);

}  // namespace weft::cli
