// SPDX-License-Identifier: Apache-2.0
#include "cli/run/bench_options.hpp"

#include <fmt/format.h>

#include <weft/core/shell_word.hpp>

#include "cli/output/new_file.hpp"
#include "cli/run/run_settings.hpp"

namespace weft::cli {

void add_bench_options(CLI::App& command, BenchOptions& options) {
  const auto text = [&](const char* name, std::string& value, const char* help) {
    return command.add_option(name, value, help)->option_text("FILE");
  };
  text("PIPELINE", options.pipeline, "Pipeline file (YAML)")->type_name("")->required();
  command
      .add_option(
          "--against", options.against,
          "Another pipeline, run in turns with it; may be repeated. Ratios are PIPELINE over it")
      ->option_text("FILE")
      ->allow_extra_args(false);
  text("--baseline", options.baseline,
       "Pipeline to which all others are compared (default: the last --against)");
  const auto number = [&](const char* name, auto& value, std::int64_t least, const char* help) {
    return command.add_option(name, value, help)
        ->option_text(fmt::format("N (default: {})", value))
        ->check(CLI::Range(least, std::int64_t{1'000'000}));
  };
  number("--frames", options.how.frames, 2,
         "Frames of each repetition whose times count; fewer by default where a source has fewer");
  number("--warmup", options.how.warmup, 0,
         "Frames before them, in every repetition, whose times do not");
  number("--repetitions", options.how.repetitions, 1, "How often the frames are run");
  number("--block", options.how.block, 1, "Frames after which it is the next pipeline's turn");
  add_settings(command, options.settings);
  command
      .add_option("--set-all", options.settings_of_all,
                  "The same for all pipelines; --set is for PIPELINE alone")
      ->option_text("PATH=VALUE")
      ->allow_extra_args(false);
  command.add_flag("--with-sinks", options.with_sinks,
                   "Run the sinks too; what they write goes to a temporary folder");
  command.add_flag("--overlap", options.overlap,
                   "Measure frames per second and the latency of a frame too, with as many frames "
                   "at once as frames_at_once and threads of each pipeline allow");
  text("--json", options.json, "Write all figures into this file");
  add_overwrite(command, options.overwrite);
  command.add_flag("--quiet", options.quiet, "No progress");
  command.add_flag("--counts", options.counts, "Run PIPELINE once and print what was counted")
      ->group("");  // this command starts it for each pipeline
}

std::vector<bench::Entry> entries_of(const BenchOptions& options) {
  std::vector<bench::Entry> entries{{"", options.pipeline, options.settings_of_all}};
  std::vector<std::string>& own = entries.front().settings;
  own.insert(own.end(), options.settings.begin(), options.settings.end());
  for (const std::string& file : options.against) {
    entries.push_back({"", file, options.settings_of_all});
  }
  if (!options.baseline.empty()) {
    entries.push_back({"", options.baseline, options.settings_of_all});
  }
  bench::name_entries(entries);
  return entries;
}

std::vector<std::string> counting_words(const bench::Entry& entry, const bench::Settings& how,
                                        bool with_sinks) {
  std::vector<std::string> words{entry.file, "--frames", std::to_string(how.frames), "--warmup",
                                 std::to_string(how.warmup)};
  for (const std::string& setting : entry.settings) {
    words.insert(words.end(), {"--set", setting});
  }
  if (with_sinks) words.emplace_back("--with-sinks");
  return words;
}

std::string command_of(const BenchOptions& options, const bench::Settings& how,
                       const Context& context) {
  std::string command = "weft";
  const auto add = [&](const std::string& option, const std::vector<std::string>& values) {
    for (const std::string& value : values) command += " " + option + " " + shell_word(value);
  };
  add("--plugin-path", context.plugin_path);
  command += " bench " + shell_word(options.pipeline);
  add("--against", options.against);
  if (!options.baseline.empty()) add("--baseline", {options.baseline});
  add("--set", options.settings);
  add("--set-all", options.settings_of_all);
  command += fmt::format(" --frames {} --warmup {} --repetitions {} --block {}", how.frames,
                         how.warmup, how.repetitions, how.block);
  command += options.overlap ? " --overlap" : "";
  return command + (options.with_sinks ? " --with-sinks" : "");
}

}  // namespace weft::cli
