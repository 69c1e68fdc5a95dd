// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <fmt/format.h>

#include <filesystem>

#include "cli/data/data_commands.hpp"
#include "cli/data/match_reader.hpp"
#include "cli/data/match_writer.hpp"
#include "cli/data/sequence_maker.hpp"
#include "cli/ending/interruption.hpp"
#include "yaml/yaml.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

/// The template that the command line describes, or that of the data.
std::string template_text(const MatchConversion& wanted, const yaml::Node& of_data) {
  if (!wanted.texture.empty() && wanted.width_m > 0.0) {
    return fmt::format(
        "template:\n  use: templates/rectangular\n  params:\n    texture: {}\n    width_m: {}\n"
        "    height_m: {}\n    columns: {}\n    rows: {}\n",
        yaml_quoted(fs::absolute(wanted.texture).string()), wanted.width_m, wanted.height_m,
        wanted.columns, wanted.rows);
  }
  if (of_data.kind != yaml::Kind::map) return {};
  yaml::Node root;
  root.kind = yaml::Kind::map;
  root.entries.push_back({"template", {}, of_data});
  return yaml::emit(root);
}

}  // namespace

void convert_matches(const MatchConversion& wanted, Context& context) {
  MatchWriter writer(wanted.folder, wanted.format);
  const MatchOrigin origin{wanted.path, wanted.camera, wanted.stage, wanted.settings,
                           wanted.tolerance_px};
  const std::atomic<bool>& interrupted = watch_for_interruption();
  now_running("the matches of " + wanted.path);
  const auto templ = read_matches(origin, context.registry(), interrupted, writer);
  Result<void> done;
  if (!templ) done = templ.error();
  if (done && writer.frames() == 0) {
    done = Error{Errc::invalid_data, "holds no matches", wanted.path};
  }
  if (done) done = writer.end(template_text(wanted, *templ), wanted.fps);
  if (!done) {
    print_error(done.error());
    writer.withdraw();
    const bool misuse = done.error().code == Errc::invalid_value;
    context.exit_code = misuse ? kBadConfiguration : kInputOutput;
    return;
  }
  if (interrupted.load()) context.exit_code = kFramesFailed;
  fmt::print("{} frames, {} matches{}: {}\n", writer.frames(), writer.matches(),
             interrupted.load() ? ", stopped early" : "", wanted.folder);
}

}  // namespace weft::cli
