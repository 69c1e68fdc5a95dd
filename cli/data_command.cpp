// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "commands.hpp"
#include "data_frex_sheet.hpp"

namespace weft::cli {

void add_data_command(CLI::App& app, Context& context) {
  CLI::App* data = app.add_subcommand("data", "Make data sets");
  data->require_subcommand(1);
  CLI::App* make = data->add_subcommand("make", "Make a data set");
  make->require_subcommand(1);
  CLI::App* frex = make->add_subcommand("frex", "Sheets of paper with exact truth");
  const auto request = std::make_shared<FrexSheetRequest>();
  frex->add_option("--sheet", request->pdf_path,
                   "Write the sheet of ArUco markers to be printed and filmed: a PDF, and beside "
                   "it its layout (.yaml) and its picture (.png)")
      ->required();
  frex->add_option("--seed", request->seed, "Chooses the places of the markers")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  frex->callback([request, &context] { context.exit_code = make_frex_sheet(context, *request); });
}

}  // namespace weft::cli
