// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pipeline/execution/frame_result.hpp"

namespace weft {

/// A stage ready for its first frame.
struct MadeStage {
  host::Instance* instance = nullptr;
  host::RecordPtr template_keypoints;  ///< detectors only
};

/// Outcome of a stage in one frame.
struct StageAnswer {
  StageReport report;
  std::vector<host::RecordPtr> outputs;  ///< null where absent
  std::vector<host::SharedText> causes;  ///< one for each output
};

/// Results that pipelines in step, in one execution context, share with one another. A stage is
/// identified by its key: equal keys promise equal work.
class StageMemo {
 public:
  /// Forgets the answers; the stages stay made.
  void next_frame() { answers_.clear(); }

  /// Null before the stage was made.
  const Result<MadeStage>* made(const std::string& key) const { return find(made_, key); }
  void keep(const std::string& key, Result<MadeStage> stage) { made_.emplace(key, stage); }

  /// Null before the stage was run in this frame.
  const StageAnswer* answer(const std::string& key) const { return find(answers_, key); }
  void keep(const std::string& key, StageAnswer answer) {
    answers_.emplace(key, std::move(answer));
  }

 private:
  template <class T>
  static const T* find(const std::map<std::string, T>& known, const std::string& key) {
    const auto found = known.find(key);
    return found != known.end() ? &found->second : nullptr;
  }

  std::map<std::string, Result<MadeStage>> made_;
  std::map<std::string, StageAnswer> answers_;
};

/// How a pipeline takes part in a memo.
struct Sharing {
  StageMemo* memo = nullptr;      ///< null: it shares nothing
  std::vector<std::string> keys;  ///< one for each stage
};

}  // namespace weft
