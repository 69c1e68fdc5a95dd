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

namespace weft {

/// What a program may say of a pipeline beside its file.
struct PipelineOptions {
  /// Laid over the file, as by `weft run --set`: "filters.alpha_s=0.2".
  std::vector<std::string> settings{};
  /// Folders of plugins, searched before WEFT_PLUGIN_PATH and before ../lib/weft/plugins of the
  /// running program.
  std::vector<std::string> plugin_path{};
  /// The program weft-worker, for stages with `isolate: process`; empty: beside the running one.
  std::string worker{};
};

/// What came of one image.
struct ProcessedFrame {
  struct Stage {
    std::string name;    ///< its `as`, else its role
    std::string status;  ///< "ok", "degenerate", "no_result", "error" or "skipped"
    std::string reason;  ///< of anything but ok, in words
    double ms = 0.0;     ///< [] ms that it took
  };

  std::uint64_t frame = 0;  ///< [] number of the image, from 0
  /// The latest shape, in memory of its own: `predicted` or `lost` where this image gave none.
  /// Nothing before the first one.
  std::optional<Shape> shape;
  bool failed = false;                ///< a stage had an error, which its reason tells
  std::vector<Stage> stages;          ///< in the order of the file
  std::vector<std::string> warnings;  ///< "STAGE: text", what components said of this image, or
                                      ///< when they were made, and "setup: text" of a set-up that
                                      ///< turns out to be wrong
  std::string report;                 ///< one JSON object: its line in frames.jsonl

  ShapeState state() const { return shape ? shape->shape_state() : ShapeState::none; }
  /// 0 to 1, see Shape; 0 without a shape.
  double confidence() const { return shape ? shape->confidence : 0.0; }
};

/// A pipeline in a program of one's own: images go in, shapes come out, no files are written. What
/// its file says of `source` and `sinks` is not looked at, and `on_error`, `max_failed`,
/// `frames_at_once` and `realtime` change nothing: the program reads, writes and decides. The same
/// images in the same order give the same shapes, bit for bit, as `weft run` of that file.
///
/// [one thread at a time] for each Pipeline, which may be another one each time; [any threads at
/// once] for different Pipelines. Work is done by the thread that calls and by those that stages
/// start; the key `threads` says how many these may be.
class Pipeline {
 public:
  /// Reads and checks the file, builds the template and prepares all stages, of which detectors
  /// look at the texture: seconds, not milliseconds. `camera` takes the images, undistorted. Of a
  /// wrong file the Error has the place of the first mistake, its sentence, and a line
  /// "place: sentence" for each further one. After a fork() only a process whose parent has loaded
  /// no pipeline can load one.
  static Result<Pipeline> load(const std::string& file, const Camera& camera,
                               const PipelineOptions& options = {});

  Pipeline(Pipeline&& other) noexcept;
  Pipeline& operator=(Pipeline&& other) noexcept;
  ~Pipeline();

  /// The mesh at rest, whose faces are those of every shape; valid as long as the pipeline.
  const Template& templ() const;

  /// Runs all stages on an undistorted image of the camera's size, [H,W] grey levels or [H,W,3]
  /// BGR, taken `t_s` seconds after the first one. The image is copied. That a stage finds nothing
  /// or fails is a result; an Error means that nothing was done: the image cannot be one of the
  /// camera, `t_s` is before that of the last image (the same time is legal), or this process was
  /// forked from the one that loaded the pipeline.
  Result<ProcessedFrame> process(const Image& image, double t_s);

 private:
  class Opened;
  explicit Pipeline(std::unique_ptr<Opened> opened);

  std::unique_ptr<Opened> opened_;
};

}  // namespace weft
