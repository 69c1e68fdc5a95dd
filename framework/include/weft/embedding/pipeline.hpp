// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>
#include <weft/embedding/frame_inputs.hpp>

namespace weft {

/// Options of a pipeline beyond its file.
struct PipelineOptions {
  /// Overrides of values in the file, as in `weft run --set`: "filters.alpha_s=0.2".
  std::vector<std::string> settings{};
  /// Plugin folders, searched before WEFT_PLUGIN_PATH and before ../lib/weft/plugins of the running
  /// program.
  std::vector<std::string> plugin_path{};
  /// Inputs of process() beside image and time that the stages may read: "correspondences",
  /// "known_points".
  std::vector<std::string> inputs{};
  /// Path of the program weft-worker, for stages with `isolate: process`; empty: next to the
  /// running program.
  std::string worker{};
};

/// Result of one image.
struct ProcessedFrame {
  struct Stage {
    std::string name;    ///< value of `as`, else the role
    std::string status;  ///< "ok", "degenerate", "no_result", "error" or "skipped"
    std::string reason;  ///< reason of a status other than ok
    double ms = 0.0;     ///< [] ms, wall-clock time
  };

  std::uint64_t frame = 0;  ///< index of the image, from 0
  /// The latest shape, with its own memory. Its state is `predicted` or `lost` if this image gave
  /// none. Empty before the first shape.
  std::optional<Shape> shape;
  bool failed = false;        ///< true if a stage failed; its reason describes the error
  std::vector<Stage> stages;  ///< stages in the order of the file
  std::vector<std::string>
      warnings;  ///< "STAGE: text" of components for this image or from their creation, and "setup:
                 ///< text" for a contradictory camera or template
  std::string report;  ///< one JSON object, the line of frames.jsonl

  ShapeState state() const { return shape ? shape->shape_state() : ShapeState::none; }
  /// Confidence of the shape, 0 to 1; 0 without a shape.
  double confidence() const { return shape ? shape->confidence : 0.0; }
};

/// A pipeline embedded in another program: images in, shapes out, no files written. The keys
/// `source` and `sinks` of the file are ignored. `on_error`, `max_failed`, `frames_at_once` and
/// `realtime` have no effect. The same images in the same order give bitwise the same shapes as
/// `weft run` of the file.
///
/// Each Pipeline may be used by one thread at a time, which may change. Different Pipelines may be
/// used by different threads at the same time. The calling thread and threads started by stages do
/// the work; the key `threads` limits their number.
class Pipeline {
 public:
  /// Reads and checks the file, builds the template and prepares all stages, which takes seconds.
  /// `camera` is the camera of the undistorted images. For an invalid file, the Error has the place
  /// and message of the first error. A line "place: message" follows for each further one. After
  /// fork(), a child can load a pipeline only if its parent has loaded none.
  static Result<Pipeline> load(const std::string& file, const Camera& camera,
                               const PipelineOptions& options = {});

  Pipeline(Pipeline&& other) noexcept;
  Pipeline& operator=(Pipeline&& other) noexcept;
  ~Pipeline();

  /// The mesh at rest, whose faces apply to every shape. Valid for the lifetime of the pipeline.
  const Template& templ() const;

  /// Runs all stages on an undistorted image of the camera's size, [H,W] grey levels or [H,W,3]
  /// BGR. `t_s` is the time in seconds since the first image. The image is copied. A stage without
  /// a result or with an error is part of the result. An Error means that nothing was processed.
  /// The image does not fit the camera, `t_s` is before the last image's time (equal is legal), or
  /// the process was forked after load().
  Result<ProcessedFrame> process(const Image& image, double t_s);

  /// The same with matches and known points beside the image or instead of it. A stage without a
  /// required input is skipped. An Error also means an input that does not fit: its `where` names
  /// it. PipelineOptions::inputs does not name it, its lengths disagree, a value is not finite, or
  /// the template has no such vertex.
  Result<ProcessedFrame> process(const FrameInputs& inputs, double t_s);

 private:
  class Opened;
  explicit Pipeline(std::unique_ptr<Opened> opened);

  std::unique_ptr<Opened> opened_;
};

}  // namespace weft
