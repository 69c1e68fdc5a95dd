// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/pipeline_keys.hpp"

#include <cstdint>
#include <limits>

#include "host/loading/component_keys.hpp"
#include "pipeline/configuration/config.hpp"

namespace weft {
namespace {

using yaml::Form;
using yaml::KeyTable;

constexpr std::int64_t kMostFrames = std::numeric_limits<std::int32_t>::max();

KeyTable keys_of_isolation() {
  return {
      {.name = "isolate",
       .help = "process: it runs in a process of its own, so that a crash costs one frame; none: "
               "it does not, though its component prefers it or did not come with the program",
       .form = Form::choice,
       .choices = {"process", "none"}},
      {.name = "deadline_ms",
       .help = "with isolate: process, after so many milliseconds a call is ended",
       .form = Form::whole,
       .low = 1,
       .high = 86'400'000},
  };
}

Place make_place(const char* what, PipelinePart part, const KeyTable& more) {
  Place made{what, host::component_keys(), roles_of(part)};
  for (const KeyTable& keys : {more, keys_of_isolation()}) {
    made.keys.insert(made.keys.end(), keys.begin(), keys.end());
  }
  made.keys.push_back({.name = "overwrite",
                       .help = "true: what it writes may go over what is there",
                       .form = Form::flag,
                       .fallback = "false"});
  return made;
}

KeyTable keys_of_sinks() {
  return {
      {.name = "as",
       .help = "its name; otherwise its role, numbered from the second without a name on: filters, "
               "filters#2",
       .form = Form::part,
       .part = "as"},
      {.name = "from",
       .help = "where inputs come from: {INPUT: NAME}, or a list of names where several are taken",
       .form = Form::part,
       .part = "from"},
  };
}

KeyTable keys_of_stages() {
  KeyTable keys = keys_of_sinks();
  const KeyTable more{
      {.name = "when",
       .help = "in which frames it is called: {not_ok: NAME, every: N}",
       .form = Form::part,
       .part = "when"},
      {.name = "template_params",
       .help = "detectors: parameters that differ on the template's texture",
       .form = Form::part,
       .part = "template_params"},
  };
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

}  // namespace

const KeyTable& pipeline_keys() {
  static const PipelineConfig kDefaults{};
  static const KeyTable kKeys{
      {.name = "weft",
       .help = "version of the format",
       .form = Form::whole,
       .low = 1,
       .high = 1,
       .required = true},
      {.name = "source",
       .help = "where the frames come from",
       .form = Form::part,
       .part = "source",
       .required = true},
      {.name = "template",
       .help = "the mesh at rest and its texture",
       .form = Form::part,
       .part = "template",
       .required = true},
      {.name = "stages",
       .help = "components in the order in which they run",
       .form = Form::part,
       .part = "stages"},
      {.name = "sinks",
       .help = "components that write, after the stages",
       .form = Form::part,
       .part = "sinks"},
      {.name = "seed",
       .help = "of all random draws",
       .form = Form::whole,
       .high = std::numeric_limits<std::int64_t>::max(),
       .fallback = std::to_string(kDefaults.seed)},
      {.name = "lost_after",
       .help = "frames after which a predicted shape is lost",
       .form = Form::whole,
       .high = 1'000'000,
       .fallback = std::to_string(kDefaults.lost_after)},
      {.name = "on_error",
       .help = "continue, or stop after a frame with an error",
       .form = Form::choice,
       .choices = {"continue", "stop"},
       .fallback = "continue"},
      {.name = "max_failed",
       .help = "frames with an error that still count as success",
       .form = Form::whole,
       .high = kMostFrames,
       .fallback = std::to_string(kDefaults.max_failed)},
      {.name = "frames_at_once",
       .help = "most frames on their way through the stages",
       .form = Form::whole,
       .low = 1,
       .high = 64,
       .fallback = std::to_string(kDefaults.frames_at_once)},
      {.name = "threads",
       .help = "that work for the run; 0: as many as processor cores",
       .form = Form::whole,
       .high = 256,
       .fallback = std::to_string(kDefaults.threads)},
      {.name = "realtime",
       .help = "all frames, or the latest that is there",
       .form = Form::choice,
       .choices = {"all", "latest"},
       .fallback = "all"},
      {.name = "sequence",
       .help = "false: frames are unordered images, so that nothing depends on the one before",
       .form = Form::flag,
       .fallback = "true"},
      {.name = "extends", .help = "a pipeline file over which this one is laid"},
      {.name = "without",
       .help = "names of stages and sinks of that file to leave out",
       .form = Form::texts},
  };
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
  static const KeyTable kKeys{
      {.name = "not_ok",
       .help = "an earlier stage, or a list of them, that answered anything but ok in this frame",
       .form = Form::part,
       .part = "names"},
      {.name = "every",
       .help = "the number of the frame is a multiple of this",
       .form = Form::whole,
       .low = 1,
       .high = kMostFrames},
  };
  return kKeys;
}

std::vector<std::string> reserved_names() {
  std::vector<std::string> names;
  for (const RoleRules& rules : all_role_rules()) names.push_back(rules.role.name);
  names.emplace_back("previous");
  return names;
}

}  // namespace weft
