// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <string>

#include "pipeline/execution/executor.hpp"
#include "pipeline/runs/run.hpp"

namespace weft {

/// The records that a run keeps of a frame, by slot:
/// - `shape`, `ground_truth`. Arrays of the truth with one value per pixel are omitted.
/// - `STAGE.correspondences`, whole, of each stage (or `sources`) that made matches.
/// - `STAGE.FILTER.inlier_mask` of each filter that processed them, `STAGE.FILTER.NEXT.inlier_mask`
///   of the next. A mask has the matches that the filter and those before it kept, and its scores.
///   If the filter gave no result, all are rejected with scores of 0.
/// - `STAGE.match_depths`, the true depth at the matches of a stage.
/// - `STAGE.warp_samples`, the points to which a warp maps the template's vertices.
/// A record that is absent in a frame has no slot.
host::NamedRecords frame_records(const Graph& graph, const FrameResult& frame,
                                 const host::RecordPtr& ground_truth);

/// The folder of one run: pipeline.yaml (effective configuration), manifest.json, template.npz
/// (template, camera), frames.jsonl (a line a frame), frames/NNNNNN.npz, the files of the sinks,
/// and at the end end.json. Finished files stay readable if the run is killed. After a power cut, a
/// folder with end.json is complete. If the run had not ended, frames that the system had not
/// written to the disk are missing. frames/NNNNNN.npz holds the frame_records; a frame without any
/// has no such file.
class RunFolder {
 public:
  /// Creates the folder; refuses one that is not empty.
  static Result<RunFolder> create(const std::string& given);

  const std::string& path() const { return path_; }

  /// Writes configuration, provenance and template, before the first frame. The argument is the
  /// number of frames of the source, -1 if unknown.
  Result<void> begin(const PipelineConfig& config, const host::Record& templ,
                     const host::Record& camera, std::int64_t source_frames);

  /// Writes one frame and what is kept of it; its line is flushed.
  Result<void> add(const FrameResult& frame, const host::NamedRecords& records);

  /// Writes all frames to the disk, then end.json: the number of frames, with which a reader can
  /// check that none is missing. If frames may be dropped (`drops`), it has the number of dropped
  /// ones too, and the evidence of the frames about the camera.
  Result<void> end(const RunSummary& summary, bool drops) const;

  /// Removes the contents of the folder, and the folder unless it was there before: it was new or
  /// empty, so that everything in it belongs to this run.
  void withdraw();

 private:
  explicit RunFolder(std::string path) : path_(std::move(path)) {}

  std::string path_;
  bool is_new_ = false;
  std::ofstream frames_;
};

}  // namespace weft
