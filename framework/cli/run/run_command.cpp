// SPDX-License-Identifier: Apache-2.0
#include <memory>

#include "cli/commands.hpp"
#include "cli/run/run_settings.hpp"
#include "cli/run/running.hpp"

namespace weft::cli {

void add_run_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "Run a pipeline on all frames of its source");
  command->add_option("PIPELINE", options->pipeline, "Pipeline file (YAML)")
      ->type_name("")
      ->required();
  command
      ->add_option("--out", options->folder,
                   "Run folder, new or empty (default: runs/<name of the pipeline>)")
      ->option_text("FOLDER");
  add_settings(*command, options->settings);
  command
      ->add_option("--dump", options->dumped,
                   "Stage (a name as in frames.jsonl) whose inputs and outputs are written into "
                   "RUN/dumps/STAGE, for `weft replay`; may be repeated")
      ->option_text("STAGE")
      ->allow_extra_args(false);
  command
      ->add_option("--repeat", options->repeated,
                   "frames.jsonl of an earlier run: take the frames that it took, and make its "
                   "changes at their frames")
      ->option_text("FILE");
  add_isolation(*command, options->isolate);
  command->add_flag("--paranoid", options->paranoid,
                    "Give components inputs that they cannot write into, nor read beyond or after "
                    "their call: one that tries is named, and ends the run. Slower; all run here "
                    "then, unless they prefer another process or --isolate all is given");
  command->add_flag("--quiet", options->quiet, "No progress bar and no table of stages");
  command->footer(
      "Exit codes:\n"
      "  0  done, or interrupted; at most max_failed frames had an error\n"
      "  1  more frames had an error, or one had with on_error: stop\n"
      "  2  the command line or the pipeline is wrong, or a component could not start\n"
      "  3  a file or folder could not be read or written after the checks\n"
      "  4  a component called exit() or _exit(); stderr names it\n"
      "  130, 143  a second SIGINT or SIGTERM ended it at once; stderr names the stage that ran");
  command->callback([&context, options] {
    if (!options->repeated.empty()) options->settings.emplace_back("realtime=all");
    run(*options, context);
  });
}

}  // namespace weft::cli
