// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "lab/bench/report.hpp"

namespace weft::cli {

/// The command line of `weft bench`.
struct BenchOptions {
  std::string pipeline, baseline, json;
  std::vector<std::string> against, settings, settings_of_all;
  bench::Settings how;
  bool frames_given = false, with_sinks = false, quiet = false, overwrite = false;
  bool overlap = false;  ///< measure several frames at once too
  bool counts = false;   ///< run one pipeline once and print what was counted
};

void add_bench_options(CLI::App& command, BenchOptions& options);

/// The pipelines with their settings: PIPELINE, those against it, the baseline.
std::vector<bench::Entry> entries_of(const BenchOptions& options);

/// The words behind `weft bench --counts` for one of them.
std::vector<std::string> counting_words(const bench::Entry& entry, const bench::Settings& how,
                                        bool with_sinks);

/// The command that repeats the measurement.
std::string command_of(const BenchOptions& options, const bench::Settings& how,
                       const Context& context);

}  // namespace weft::cli
