// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <string>
#include <weft/pipeline/executor.hpp>

namespace weft {

/// The folder of one run: pipeline.yaml (effective configuration), manifest.json, template.npz
/// (template, camera), frames.jsonl (a line a frame), frames/NNNNNN.npz (shape, ground_truth, and
/// for each filter STAGE.matches and STAGE.inlier_mask) and what the sinks write. Whatever is
/// finished stays readable when the run is killed.
class RunFolder {
 public:
  /// Creates the folder; refuses one that is not empty.
  static Result<RunFolder> create(const std::string& path);

  const std::string& path() const { return path_; }

  /// Writes configuration, provenance and template, before the first frame.
  Result<void> begin(const PipelineConfig& config, const host::Record& templ,
                     const host::Record& camera);

  /// Writes one frame; its line is flushed.
  Result<void> add(const FrameResult& frame, const host::RecordPtr& ground_truth);

 private:
  explicit RunFolder(std::string path) : path_(std::move(path)) {}

  std::string path_;
  std::ofstream frames_;
};

}  // namespace weft
