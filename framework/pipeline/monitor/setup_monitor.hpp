// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/execution/frame_result.hpp"
#include "pipeline/execution/run_warning.hpp"
#include "pipeline/monitor/camera_judgement.hpp"
#include "pipeline/monitor/rejected_matches.hpp"
#include "pipeline/monitor/self_calibration.hpp"

namespace weft {

/// Watches a run for frames that contradict its set-up: another camera, a texture that is not that
/// of the object, a second print in view, too few frames a second. Its findings are warnings. It
/// moves no vertex, but lowers the confidence of shapes if the camera is wrong.
class SetupMonitor {
 public:
  /// In frames that are no sequence, the motion between them is not judged, and a frame that shows
  /// a second print is `weak`.
  static Result<SetupMonitor> create(const host::Record& templ, host::RecordPtr camera,
                                     bool is_sequence = true);

  /// Checks some frames closely: the first eight, then each time the number of frames has grown by
  /// a quarter. Its observations are added to the frame's `setup`, and its findings so far to its
  /// `warnings`. Once the camera turns out to be wrong, the confidence of measured shapes is
  /// lowered, and `estimated` becomes `weak` if it falls below 0.5; `reason` has the cause.
  void add(const Graph& graph, FrameResult& frame);

  /// All that is found out by now, as warnings of "setup".
  std::vector<RunWarning> warnings() const;

  /// The evidence of all frames about the camera, named as in the `setup` of a frame, with
  /// `frames`, the number of unlike frames used. `centre_alone_*` is the principal point if focal
  /// lengths and lens are fixed; see run_figures() for `focal_by_side`. Empty if fewer than three
  /// frames contribute.
  std::vector<std::pair<std::string, double>> camera() const;

 private:
  struct Finding {
    std::string kind;  ///< "focal length": each is reported once in frames
    std::string text;
    std::int64_t frames;  ///< that show it
  };
  SetupMonitor(host::RecordPtr camera, SelfCalibration calibration)
      : camera_(std::move(camera)), calibration_(std::move(calibration)) {}

  bool is_due(std::uint64_t frame);
  /// True if the shape is unlike those that the camera was judged by; then it is one of them.
  bool is_news(const Shape& shape);
  void look(const Graph& graph, const Shape* shape, const Correspondences& matches,
            FrameResult& frame);
  void doubt(const Graph& graph, const Shape& shape, FrameResult& frame);
  void doubt_choice(const Graph& graph, const Shape& shape, FrameResult& frame);
  /// Gives the shape the state of the frame, this reason and at most this confidence.
  static void limit_confidence(const Graph& graph, double most, std::string reason,
                               FrameResult& frame);
  void project(const Shape& shape);
  void look_at_camera(const Shape& shape, const Correspondences& matches, FrameResult& frame);
  void look_at_rejects(const Correspondences& matches, FrameResult& frame);
  void count_recognised(const FrameResult& frame, const Shape* shape,
                        const Correspondences& matches);
  void count_jumps(const Shape* shape, std::uint64_t frame);

  std::vector<Finding> findings() const;
  void judge_camera(std::vector<Finding>& findings) const;
  void judge_rejects(std::vector<Finding>& findings) const;
  void judge_recognition(std::vector<Finding>& findings) const;
  void judge_jumps(std::vector<Finding>& findings) const;

  host::RecordPtr camera_;
  SelfCalibration calibration_;
  RejectedMatches rejected_;
  Points2 now_px_;  ///< the vertices of the shape that is looked at
  std::uint64_t looks_ = 0, next_look_ = 0;
  std::vector<std::string> reported_;  ///< kinds of findings

  std::vector<CameraEvidence> cameras_;  ///< evidence of each frame that has some
  std::vector<Points2> places_px_;       ///< vertices of the frames that were evaluated
  double radius_ = 0.0;                  ///< [] of the farthest match, X / Z
  std::vector<CameraFault> faults_;      ///< by the frames that were evaluated
  std::int64_t weakened_ = 0;            ///< [frames] for one of them

  std::int64_t rejects_looks_ = 0, with_rejects_ = 0;  ///< [frames]
  std::int64_t rejects_ = 0, rejects_elsewhere_ = 0;   ///< counts of the frames with many
  int coherent_rejects_ = 0;  ///< count of this frame, where they are many and a second print's

  std::int64_t with_matches_ = 0, recognised_ = 0;  ///< [frames]
  double most_agreeing_ = 0.0;                      ///< matches, in a frame

  Points2 before_px_;                    ///< vertices of the last shape that was estimated
  std::optional<std::uint64_t> before_;  ///< its frame
  bool is_sequence_ = true;
  std::int64_t pairs_ = 0, jumps_ = 0;  ///< counts of neighbouring frames
  double jumps_sum_ = 0.0;              ///< [] of the object's size
};

}  // namespace weft
