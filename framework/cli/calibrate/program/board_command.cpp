// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>
#include <weft/core/whole_file.hpp>

#include "cli/calibrate/program/program.hpp"
#include "cli/output/new_file.hpp"
#include "cli/output/outcome.hpp"
#include "lab/calibration/board.hpp"

namespace weft::cli {
namespace {

struct PageOptions {
  BoardOptions board;
  std::string paper = "a4", out;
  bool overwrite = false;
};

Result<void> write_page(const PageOptions& options) {
  if (!options.out.ends_with(".pdf")) {
    return Error{Errc::invalid_value, "writes a PDF: let its name end with .pdf", "--out"};
  }
  const auto board = board_of(options.board);
  if (!board) return board.error();
  const auto paper = calibration::find_paper(options.paper);
  if (!paper) return paper.error();
  const auto page = calibration::board_page(*board, *paper);
  if (!page) return page.error();
  if (auto fresh = check_new_file(options.out, options.overwrite); !fresh) return fresh;
  return write_whole(*page, options.out);
}

}  // namespace

Result<calibration::Board> board_of(const BoardOptions& options) {
  return calibration::parse_board(options.squares, options.square_m, options.pattern,
                                  options.dictionary, options.marker_share);
}

void add_board_options(CLI::App& app, BoardOptions& options) {
  app.add_option("--board", options.pattern,
                 "Board: charuco, chessboard, circles or asymmetric-circles")
      ->option_text("NAME [charuco]");
  app.add_option("--squares", options.squares, "Squares of the board, or circles in a row and rows")
      ->option_text("COLUMNSxROWS [7x5]");
  app.add_option(
         "--square", options.square_m,
         "Side of a square as measured on the printed board, or distance of rows of circles")
      ->option_text("METRES [0.03]");
  app.add_option("--dictionary", options.dictionary,
                 "Dictionary of ArUco markers of a charuco board")
      ->option_text("NAME [4x4_250]");
  app.add_option("--marker-share", options.marker_share,
                 "Side of a marker of a charuco board, as a share of that of its square")
      ->option_text("SHARE [0.6]");
}

int exit_code_of(const Error& error) {
  if (error.code == Errc::no_result) return kNotDetermined;
  return error.code == Errc::io || error.code == Errc::not_found ? kInputOutput : kBadConfiguration;
}

void add_board_command(CLI::App& app, int& exit_code) {
  const auto options = std::make_shared<PageOptions>();
  CLI::App* command = app.add_subcommand("board", "Write the board to print, as PDF");
  command->add_option("--out", options->out, "The page")->option_text("FILE.pdf")->required();
  add_board_options(*command, options->board);
  command->add_option("--paper", options->paper, "Paper: a4, a3, a2 or letter")
      ->option_text("NAME [a4]");
  add_overwrite(*command, options->overwrite);
  command->callback([options, &exit_code] {
    const auto written = write_page(*options);
    if (!written) {
      print_error(written.error());
      exit_code = exit_code_of(written.error());
      return;
    }
    fmt::print(
        "{}\nPrint it at 100 %, glue it to something flat and stiff, and measure a square.\n",
        options->out);
  });
}

}  // namespace weft::cli
