// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/loading/component_spec.hpp"
#include "host/workers/isolation.hpp"
#include "pipeline/configuration/document.hpp"

namespace weft {

/// An input that a stage takes from a named output instead of the latest of its type.
struct FromRule {
  std::string slot;
  std::vector<std::string> names;  ///< several for an input that takes several records; none when
                                   ///< the rule cannot be understood, which has been reported
  yaml::Position at;
};

/// In which frames a stage is called: in those in which at least one of these holds.
struct CallRule {
  struct Name {
    std::string name;
    yaml::Position at;
  };
  std::vector<Name> not_ok;  ///< an earlier stage that answered anything but ok in this frame
  std::int64_t every = 0;    ///< [frames] its number is a multiple of this; 0: no such rule
  bool unclear = false;      ///< see yaml::Node
};

/// One stage or sink of a pipeline.
struct StageConfig {
  std::string name;               ///< see names_of_stages
  bool named = false;             ///< `as` was given
  std::string role;               ///< expected role of its plugin; empty if unknown
  std::vector<FromRule> from;     ///< [.] rules of the key `from`
  host::ComponentSpec component;  ///< without `installed` where the plugin is not known
  /// Detectors: the component with `template_params` over `params`, for the template's texture.
  std::optional<host::ComponentSpec> on_template;
  bool overwrite = false;                    ///< its outputs may go over what is there
  std::optional<host::Isolation> isolation;  ///< `isolate: process`; nothing runs it in this one
  bool stays_here = false;           ///< it has none, though there is a reason to give it one
  bool isolated_by_default = false;  ///< it has one that the pipeline does not request
  std::optional<CallRule> when;      ///< else it is called in every frame
  yaml::Position at;
};

/// A pipeline file, checked but not yet wired.
struct PipelineConfig {
  std::string file;
  std::vector<ConfigSource> sources;  ///< the file, what it extends, what the command line sets
  std::vector<LeftOut> left_out;
  std::optional<StageConfig> source;
  std::optional<StageConfig> templ;
  std::vector<StageConfig> stages;  ///< [.] in the order of the file
  std::vector<StageConfig> sinks;   ///< [.] in the order of the file
  std::uint64_t seed = 0;           ///< [] seed of the run
  int lost_after = 30;              ///< [frames] a predicted shape older than this is lost
  bool stop_on_error = false;       ///< else the run goes on after a failed frame
  int max_failed = 0;               ///< failed frames that still count as success
  int frames_at_once = 0;           ///< most frames in the stages; 0: see frames_at_once_of()
  int threads = 0;                  ///< that work for a run; 0: one a processor core
  int budget_ms = 0;                ///< [ms] wall-clock time of a frame in the stages; 0: no bound
  bool is_sequence = true;          ///< else frames are unordered: none has one before it
  bool latest_only = false;         ///< `realtime: latest`: frames that come meanwhile are dropped
  bool in_program = false;          ///< see PipelineDocument: there is neither source nor sink
  std::vector<std::string> given;   ///< see PipelineDocument
  Isolating isolating = Isolating::preferred;  ///< the chosen isolation
  std::vector<std::string> doubts;             ///< warnings of the report, with their places
  /// An error makes the names of some stages unknown, so that missing names may only be a
  /// consequence of it.
  bool unclear_names = false;
};

/// Errors of a pipeline with their places.
struct ConfigReport {
  std::vector<ConfigSource> sources;    ///< by yaml::Position::source
  std::vector<yaml::Problem> problems;  ///< [.] errors with their places
  /// It is not known which stages there are, so that wiring cannot be checked, see yaml::Node.
  bool unclear_stages = true;
  std::vector<yaml::Problem> warnings;  ///< legal, but doubtful settings

  bool ok() const { return problems.empty(); }
  /// Sorts by place.
  void sort();
  /// One line per error: place_in(sources) and the sentence.
  std::string text() const;
};

/// Reads a pipeline file with the files that it extends, merges `patches` into it, sets `settings`
/// ("filters.alpha_s=0.2", see read_document) and checks everything but the wiring. One pass
/// reports all errors that do not merely follow from another one, by place; a syntax error is
/// reported alone. Use the configuration only when the report is ok, or for the wiring.
std::pair<PipelineConfig, ConfigReport> load_pipeline(const std::string& file,
                                                      const host::Registry& registry,
                                                      const std::string& output_folder,
                                                      const std::vector<std::string>& settings = {},
                                                      const std::vector<Patch>& patches = {});

/// The same of a document that has been read from `file`.
std::pair<PipelineConfig, ConfigReport> load_pipeline(const std::string& file,
                                                      PipelineDocument document,
                                                      const host::Registry& registry,
                                                      const std::string& output_folder);

/// The error of a component, at the place of the parameter that it is about, where there is one and
/// no other stage has the same component.
Error placed(Error error, const PipelineConfig& config);

/// True if any component has its own process, so that records must be in shared memory.
bool has_isolated(const PipelineConfig& config);

/// True if texts contain secrets such as tokens, or variables of the environment instead of them.
enum class Secrets { hidden, shown };

/// The configuration with all defaults filled in and paths resolved, as YAML.
std::string effective_yaml(const PipelineConfig& config, Secrets secrets = Secrets::hidden);

}  // namespace weft
