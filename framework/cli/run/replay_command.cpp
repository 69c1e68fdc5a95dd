// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <weft/core/statistics.hpp>

#include "cli/commands.hpp"
#include "cli/ending/interruption.hpp"
#include "cli/output/new_file.hpp"
#include "pipeline/dumps/replay.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

struct ReplayOptions {
  std::string stage, records, params, out;
  int repeat = 1;
};

const char* name_of(weft_status status) {
  constexpr const char* kNames[] = {"ok", "degenerate", "no_result", "error", "cancelled", "end"};
  return kNames[static_cast<int>(status)];
}

/// Errors in files get the exit code of input and output, all others that of the caller.
int exit_code_of(const Error& error) {
  const bool file =
      error.code == Errc::io || error.code == Errc::syntax || error.code == Errc::invalid_data;
  return file ? kInputOutput : kBadConfiguration;
}

/// The files of the calls, in the order of their frames.
Result<std::vector<std::string>> calls_of(const std::string& records, const std::string& folder) {
  if (!fs::is_directory(records)) return std::vector<std::string>{records};
  std::vector<std::string> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const fs::path& file = entry.path();
    if (file.extension() == ".npz" && file.filename() != "template.npz") {
      files.push_back(file.string());
    }
  }
  if (files.empty()) return Error{Errc::io, "holds no calls: the stage ran in no frame", folder};
  // Frame numbers of more than six digits are longer.
  std::sort(files.begin(), files.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return files;
}

/// Totals of all calls.
struct Summary {
  int identical = 0, different = 0;
  std::vector<double> ms;
};

void print_call(const StageCall& call, const Replayed& replayed) {
  fmt::print("frame {}: {}, {:.3f} ms", call.frame, name_of(replayed.outcome.status),
             percentile(replayed.ms, 50.0));
  fmt::print("{}\n", replayed.differences.empty() ? ", identical" : "");
  for (const std::string& difference : replayed.differences) fmt::print("    {}\n", difference);
}

Result<Summary> replay_all(Replay& replay, const DumpedStage& stage,
                           const std::vector<std::string>& files, const ReplayOptions& options) {
  Summary summary;
  for (const std::string& file : files) {
    const auto call = read_call(file, stage);
    if (!call) return call.error();
    if (auto valid = replay.check(*call); !valid) {
      return Error{valid.error().code, valid.error().message, file};
    }
    const Replayed replayed = replay.run(*call, options.repeat);
    print_call(*call, replayed);
    ++(replayed.differences.empty() ? summary.identical : summary.different);
    summary.ms.insert(summary.ms.end(), replayed.ms.begin(), replayed.ms.end());
    if (options.out.empty()) continue;
    const std::string target = options.out + "/" + dumped_call_name(call->frame);
    const auto written = write_call(target, {call->stage, call->frame, {}, replayed.outcome});
    if (!written) return written.error();
  }
  return summary;
}

Result<Summary> replay(const ReplayOptions& options, const Context& context) {
  const auto folder = find_dump(options.records, options.stage);
  if (!folder) return folder.error();
  const auto stage = read_dumped_stage(*folder);
  if (!stage) return stage.error();
  const auto files = calls_of(options.records, *folder);
  if (!files) return files.error();
  const auto registry = context.registry();
  const auto replay = Replay::create(registry, *stage, options.params);
  if (!replay) {
    // No file is to blame for errors of the components.
    const Error& error = replay.error();
    return Error{error.code == Errc::io ? Errc::io : Errc::invalid_value, error.message,
                 error.where};
  }
  if (!options.out.empty()) {
    if (auto made = make_new_folder(options.out); !made) return made.error();
  }
  if ((*replay)->is_rebuilt()) {
    fmt::print("the plugin is another build than the one that was dumped\n");
  }
  return replay_all(**replay, *stage, *files, options);
}

void run(const ReplayOptions& options, Context& context) {
  now_running("the dumped calls of " + options.stage);
  const auto summary = replay(options, context);
  if (!summary) {
    print_error(summary.error());
    context.exit_code = exit_code_of(summary.error());
    return;
  }
  fmt::print("{} calls: {} identical, {} different; median {:.3f} ms\n",
             summary->identical + summary->different, summary->identical, summary->different,
             percentile(summary->ms, 50.0));
  // Other parameters are meant to make a difference.
  if (summary->different > 0 && options.params.empty()) context.exit_code = kDifferent;
}

}  // namespace

void add_replay_command(CLI::App& app, Context& context) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* command =
      app.add_subcommand("replay", "Run one stage on what `weft run --dump` wrote, and compare");
  command->footer(
      "Exit codes:\n"
      "  0  all outputs are identical, or with --params\n"
      "  1  some are not\n"
      "  2  the command line, the stage or a parameter is wrong\n"
      "  3  a file or folder cannot be read or written");
  command->add_option("STAGE", options->stage, "Name of the stage, as in frames.jsonl")
      ->type_name("")
      ->required();
  command
      ->add_option("RECORDS", options->records,
                   "Run folder, folder of the dump, or one of its files (NNNNNN.npz)")
      ->type_name("")
      ->required();
  command
      ->add_option("--params", options->params,
                   "Parameters over the dumped ones, as a YAML map: \"{alpha_s: 0.2}\"; "
                   "differences are then printed with exit code 0")
      ->option_text("MAP");
  command->add_option("--out", options->out, "Write the new outputs into this folder, new or empty")
      ->option_text("FOLDER");
  command
      ->add_option("--repeat", options->repeat,
                   "Repeat each call, and print the median of its time")
      ->option_text(fmt::format("N (default: {})", options->repeat))
      ->check(CLI::Range(1, 1'000'000));
  command->callback([&context, options] { run(*options, context); });
}

}  // namespace weft::cli
