// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/execution/stage_maker.hpp"
#include "pipeline/graph/graph.hpp"

namespace weft {

/// A stage ready to take the place of the one that runs.
struct StageChange {
  std::size_t stage = 0;  ///< its index
  std::shared_ptr<const StageConfig> config;
  MadeStage made;
};

/// The result of a setting.
struct PipelineChange {
  std::vector<StageChange> stages;  ///< empty if the setting changes nothing
  std::string settings;             ///< settings_json() from then on
};

/// Makes changes of a running pipeline, one behind another: each is merged into those before it.
/// For one thread, beside the frames.
class ChangeMaker {
 public:
  /// The running pipeline with these settings merged into it, checked and wired; the Error
  /// describes their first error.
  using Check = std::function<Result<CheckedPipeline>(const std::vector<std::string>& settings)>;

  /// The pipeline outlives this.
  ChangeMaker(const CheckedPipeline& pipeline, StageMaker maker, Check check);

  /// `setting` as of `weft run --set`. Refuses what is no parameter of a stage, what `check`
  /// refuses, what would read other values than it reads, and what cannot be made; the changes
  /// before stay.
  Result<PipelineChange> make(const std::string& setting);

  /// All changes so far with `more` merged into them, in the form of `weft run --set`; refuses what
  /// `check` refuses. Unlike changes, these settings may be of the source, the template or a sink.
  Result<std::vector<std::string>> with_changes(const std::vector<std::string>& more) const;

  /// The pipeline with all changes so far, as YAML without secrets.
  Result<std::string> yaml() const;

  /// Discards a change that is not needed any more.
  void discard(const PipelineChange& change) const;

 private:
  Result<std::size_t> stage_of(const std::string& setting) const;
  Result<PipelineChange> changed(std::size_t stage, CheckedPipeline checked);

  const CheckedPipeline& pipeline_;
  StageMaker maker_;
  Check check_;
  std::vector<std::string> settings_;   ///< the last one of each path
  std::vector<yaml::Node> components_;  ///< one a stage: its effective configuration by now
};

}  // namespace weft
