// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/pipeline_keys.hpp"

#include <cstdint>
#include <limits>

#include "host/loading/component_keys.hpp"
#include "pipeline/configuration/config.hpp"

namespace weft {
namespace {

using yaml::KeyTable;
using yaml::KeyTableBuilder;

constexpr std::int64_t kMostFrames = std::numeric_limits<std::int32_t>::max();

Place make_place(const char* what, PipelinePart part, const KeyTable& more) {
  return {what,
          KeyTableBuilder(host::component_keys())
              .all(more)
              .choice("isolate", {"process", "none"},
                      "process: it runs in a separate process, so that a crash costs one frame; "
                      "none: it does not, even if its component prefers it or is third-party")
              .whole("deadline_ms", 1, 86'400'000,
                     "with isolate: process, the milliseconds after which a call is ended")
              .flag("overwrite", "true: what it writes may go over what is there")
              .otherwise("false"),
          roles_of(part)};
}

KeyTable keys_of_sinks() {
  return KeyTableBuilder()
      .part("as", "as",
            "its name; otherwise its role, numbered from the second without a name on: filters, "
            "filters#2")
      .part("from", "from",
            "where inputs come from: {INPUT: NAME}, or a list of names where several are taken");
}

KeyTable keys_of_stages() {
  return KeyTableBuilder(keys_of_sinks())
      .part("when", "when", "in which frames it is called: {not_ok: NAME, every: N}")
      .part("template_params", "template_params",
            "detectors: parameters that differ on the template's texture");
}

}  // namespace

const KeyTable& pipeline_keys() {
  static const PipelineConfig kDefaults{};
  static const KeyTable kKeys =
      KeyTableBuilder()
          .whole("weft", 1, 1, "version of the format")
          .required()
          .part("source", "source", "where the frames come from")
          .required()
          .part("template", "template", "the mesh at rest and its texture")
          .required()
          .part("stages", "stages", "components in the order in which they run")
          .part("sinks", "sinks", "components that write, after the stages")
          .whole("seed", 0, std::numeric_limits<std::int64_t>::max(), "of all random draws")
          .otherwise(std::to_string(kDefaults.seed))
          .whole("lost_after", 0, 1'000'000, "frames after which a predicted shape is lost")
          .otherwise(std::to_string(kDefaults.lost_after))
          .choice("on_error", {"continue", "stop"}, "continue, or stop after a frame with an error")
          .otherwise("continue")
          .whole("max_failed", 0, kMostFrames, "frames with an error that still count as success")
          .otherwise(std::to_string(kDefaults.max_failed))
          .whole("frames_at_once", 0, 64,
                 "most frames on their way through the stages; 0: two where that is faster")
          .otherwise(std::to_string(kDefaults.frames_at_once))
          .whole("threads", 0, 256, "that work for the run; 0: as many as processor cores")
          .otherwise(std::to_string(kDefaults.threads))
          .whole("budget_ms", 0, 600'000,
                 "time of a frame in the stages, which some then keep by doing less; 0: no bound")
          .otherwise(std::to_string(kDefaults.budget_ms))
          .choice("realtime", {"all", "latest"}, "all frames, or the latest that is there")
          .otherwise("all")
          .flag("sequence",
                "false: frames are unordered images, so that nothing depends on the one before")
          .otherwise("true")
          .text("extends", "a pipeline file over which this one is laid")
          .texts("without", "names of stages and sinks of that file to omit");
  return kKeys;
}

const Place& place_of(PipelinePart part) {
  static const Place kSource = make_place("the source", PipelinePart::source, {});
  static const Place kTemplate = make_place("the template", PipelinePart::templ, {});
  static const Place kStage = make_place("a stage", PipelinePart::stage, keys_of_stages());
  static const Place kSink = make_place("a sink", PipelinePart::sink, keys_of_sinks());
  switch (part) {
    case PipelinePart::source:
      return kSource;
    case PipelinePart::templ:
      return kTemplate;
    case PipelinePart::stage:
      return kStage;
    case PipelinePart::sink:
      break;
  }
  return kSink;
}

const KeyTable& condition_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder()
          .part("not_ok", "names",
                "an earlier stage, or a list of them, that answered anything but ok in this frame")
          .whole("every", 1, kMostFrames, "the number of the frame is a multiple of this");
  return kKeys;
}

std::vector<std::string> reserved_names() {
  std::vector<std::string> names;
  for (const RoleRules& rules : all_role_rules()) names.push_back(rules.role.name);
  names.emplace_back("previous");
  return names;
}

}  // namespace weft
