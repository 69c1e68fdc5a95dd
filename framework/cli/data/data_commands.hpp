// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.hpp"

namespace weft::cli {

// `weft data COMMAND`; each adds its own, and its callback sets Context::exit_code.
void add_data_info(CLI::App& data, Context& context);
void add_data_convert(CLI::App& data, Context& context);
/// Arguments of `weft data convert --matches`.
struct MatchConversion {
  std::string path, folder;
  std::string format;  ///< csv or npz
  std::string stage;
  std::string camera, texture;
  double width_m = 0.0, height_m = 0.0;
  int columns = 0, rows = 0;
  double fps = 30.0, tolerance_px = 2.0;
  std::vector<std::string> settings;
};
/// Writes the matches of a run, a sequence or a set of files as a sequence of matches.
void convert_matches(const MatchConversion& wanted, Context& context);

// `weft data make KIND`; each adds its kind.
void add_data_make_frex(CLI::App& make, Context& context);

}  // namespace weft::cli
