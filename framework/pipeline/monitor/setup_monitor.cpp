// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/setup_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>

#include "pipeline/execution/compose.hpp"
#include "pipeline/monitor/joint_deviation.hpp"

namespace weft {
namespace {

constexpr std::int64_t kFewestFrames = 3, kFewestForRates = 5;
constexpr Eigen::Index kMostVertices = 4000;  // more would hold a frame up for seconds

/// The matches that filters kept; all of them if a filter had no result. Null without any.
host::RecordPtr last_matches(const Graph& graph, const FrameResult& frame) {
  host::RecordPtr last;
  for (std::size_t i = 0; i < frame.values.size(); ++i) {
    const bool matches = graph.values[i].slot == "correspondences" && frame.values[i] != nullptr;
    if (matches) last = frame.values[i];
  }
  return last;
}

/// Where a filter first rejected some of the matches: later stages may keep others beside the ones
/// of keypoints, or look near a shape alone. Null where nothing was rejected.
host::RecordPtr first_filtered(const Graph& graph, const FrameResult& frame) {
  for (std::size_t i = 0; i < frame.values.size(); ++i) {
    if (graph.values[i].slot != "correspondences" || frame.values[i] == nullptr) continue;
    const auto matches = host::arrays_of<Correspondences>(*frame.values[i]);
    const std::uint8_t* kept = matches->kept.data();
    if (std::find(kept, kept + matches->count(), 0) != kept + matches->count()) {
      return frame.values[i];
    }
  }
  return nullptr;
}

/// How far places have moved, in sizes of the object as it was seen before.
double mean_way(const Points2& from_px, const Points2& to_px) {
  const double size_px = (from_px.colwise().maxCoeff() - from_px.colwise().minCoeff()).norm();
  return (to_px - from_px).rowwise().norm().mean() / size_px;
}

/// A scalar that a component calls evidence, or `fallback`.
double evidence_in(const host::Record& record, const char* name, double fallback) {
  const weft_array* found = find_array(record.view(""), name);
  const bool is_number = found != nullptr && found->ndim == 0 && found->dtype == WEFT_F64;
  return is_number ? *static_cast<const double*>(found->data) : fallback;
}

bool is_measured(const FrameResult& frame) {
  return frame.state == ShapeState::estimated || frame.state == ShapeState::weak;
}

}  // namespace

Result<SetupMonitor> SetupMonitor::create(const host::Record& templ, host::RecordPtr camera,
                                          bool is_sequence) {
  const auto sheet = host::view_as<Template>(templ);
  if (!sheet) return sheet.error();
  auto calibration = SelfCalibration::of(*sheet);
  if (!calibration) return calibration.error();
  SetupMonitor monitor(std::move(camera), *std::move(calibration));
  monitor.is_sequence_ = is_sequence;
  return monitor;
}

bool SetupMonitor::is_due(std::uint64_t frame) {
  constexpr std::uint64_t kFirst = 8;
  if (looks_ >= kFirst && frame < next_look_) return false;
  ++looks_;
  next_look_ = frame + frame / 4;
  return true;
}

void SetupMonitor::add(const Graph& graph, FrameResult& frame) {
  const auto shape = is_measured(frame) ? host::arrays_of<Shape>(*frame.shape)
                                        : Result<Shape>(no_result("not measured"));
  count_jumps(frame.state == ShapeState::estimated && shape ? &*shape : nullptr, frame.index);
  if (const host::RecordPtr matches = last_matches(graph, frame)) {
    look(graph, shape ? &*shape : nullptr, *host::arrays_of<Correspondences>(*matches), frame);
  }
  if (shape && !faults_.empty()) doubt(graph, *shape, frame);
  if (shape && !is_sequence_) doubt_choice(graph, *shape, frame);
}

void SetupMonitor::look(const Graph& graph, const Shape* shape, const Correspondences& matches,
                        FrameResult& frame) {
  const bool solves = graph.latest("shape") >= 0;
  if (solves) count_recognised(frame, shape, matches);
  const bool is_due_now = is_due(frame.index);
  if (is_due_now && shape != nullptr) look_at_camera(*shape, matches, frame);
  coherent_rejects_ = 0;
  if (is_due_now || !is_sequence_) {
    const host::RecordPtr filtered = first_filtered(graph, frame);
    look_at_rejects(filtered != nullptr ? *host::arrays_of<Correspondences>(*filtered) : matches,
                    frame);
  }
  if (!is_due_now) return;
  for (Finding& found : findings()) {
    if (std::find(reported_.begin(), reported_.end(), found.kind) != reported_.end()) continue;
    reported_.push_back(found.kind);
    frame.warnings.push_back(std::move(found.text));
  }
}

/// A solver's confidence is valid if the camera is right. If the camera is known to be wrong, the
/// shape is right only if the deviation does not matter. If a stretched surface explains the frames
/// as well, the shape is as likely wrong as right. The next frame is still solved from the shape as
/// the solver gave it.
void SetupMonitor::doubt(const Graph& graph, const Shape& shape, FrameResult& frame) {
  constexpr double kEven = 0.5;  // the least of an estimated shape, see state_of()
  const auto likeliest_right = [](const CameraFault& fault) {
    return fault.is_sure ? fault.fine : kEven;
  };
  const CameraFault& worst = *std::min_element(faults_.begin(), faults_.end(),
                                               [&](const CameraFault& a, const CameraFault& b) {
                                                 return likeliest_right(a) < likeliest_right(b);
                                               });
  const double confidence =
      worst.is_sure ? shape.confidence * worst.fine : std::min(shape.confidence, kEven);
  const bool weakens = frame.state == ShapeState::estimated && confidence < kEven;
  if (weakens) {
    frame.state = ShapeState::weak;
    ++weakened_;
  }
  limit_confidence(graph, confidence, worst.claim, frame);
}

/// In a video, the previous frame determines which of two equal textures is tracked. A single image
/// does not: the other texture is equally likely the intended one.
void SetupMonitor::doubt_choice(const Graph& graph, const Shape& shape, FrameResult& frame) {
  if (coherent_rejects_ == 0) return;
  if (frame.state == ShapeState::estimated) frame.state = ShapeState::weak;
  limit_confidence(
      graph, shape.confidence / 2.0,
      "a second print like the texture seems to be in view: " + std::to_string(coherent_rejects_) +
          " rejected matches agree with each other; cover it, cut it off, or give "
          "the source a 'region'",
      frame);
}

void SetupMonitor::limit_confidence(const Graph& graph, double most, std::string reason,
                                    FrameResult& frame) {
  const double confidence = std::min(most, host::arrays_of<Shape>(*frame.shape)->confidence);
  frame.reason = std::move(reason);
  frame.shape = doubted_shape(*frame.shape, frame.state, confidence, frame.reason);
  frame.values[to_index(graph.latest("shape"))] = frame.shape;
}

/// Frames that look alike have similar errors, caused by the template. All of them together count
/// as one.
bool SetupMonitor::is_news(const Shape& shape) {
  constexpr double kAlike = 0.015;
  project(shape);
  for (const Points2& before_px : places_px_) {
    if (mean_way(before_px, now_px_) < kAlike) return false;
  }
  places_px_.push_back(now_px_);
  return true;
}

void SetupMonitor::project(const Shape& shape) {
  const auto camera = *host::arrays_of<Camera>(*camera_);
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const auto vertices_m = shape.vertices_m.matrix<3>();
  now_px_.resize(vertices_m.rows(), 2);
  for (Eigen::Index i = 0; i < vertices_m.rows(); ++i) {
    now_px_.row(i) = weft::project(pinhole, vertices_m.row(i)).transpose();
  }
}

void SetupMonitor::look_at_camera(const Shape& shape, const Correspondences& matches,
                                  FrameResult& frame) {
  const auto camera = *host::arrays_of<Camera>(*camera_);
  if (shape.vertices_m.rows() > kMostVertices || !is_news(shape)) return;
  const auto evidence = calibration_.look(camera, shape.vertices_m.matrix<3>(), matches);
  if (!evidence) return;
  cameras_.push_back(*evidence);
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0 || matches.face(i) < 0) continue;
    radius_ = std::max(radius_, std::hypot((matches.image_px(i, 0) - camera.cx) / camera.fx,
                                           (matches.image_px(i, 1) - camera.cy) / camera.fy));
  }
  if (static_cast<std::int64_t>(cameras_.size()) >= kFewestFrames) {
    faults_ = camera_faults(cameras_, camera, radius_);
  }
  for (const auto& [name, value] : camera_figures(CameraDeviation::of(*evidence), camera)) {
    frame.setup.emplace_back(name, value);
  }
}

void SetupMonitor::look_at_rejects(const Correspondences& matches, FrameResult& frame) {
  constexpr int kFewest = 30;
  constexpr double kLeastShare = 0.25;
  const CoherentRejects found = rejected_.look(matches);
  const double kept = matches.kept.matrix<1>().cast<double>().sum();
  ++rejects_looks_;
  frame.setup.insert(frame.setup.end(), {{"coherent_rejects", found.count},
                                         {"coherent_rejects_elsewhere", found.elsewhere}});
  if (found.count < kFewest || found.count < kLeastShare * kept) return;
  ++with_rejects_;
  if (2 * found.elsewhere <= found.count) coherent_rejects_ = found.count;
  rejects_ += found.count;
  rejects_elsewhere_ += found.elsewhere;
}

void SetupMonitor::count_recognised(const FrameResult& frame, const Shape* shape,
                                    const Correspondences& matches) {
  constexpr double kFewest = 30.0;
  const double kept = matches.kept.matrix<1>().cast<double>().sum();
  const double agreeing =
      shape == nullptr ? 0.0 : evidence_in(*frame.shape, "diag.agreeing_matches", kept);
  ++with_matches_;
  most_agreeing_ = std::max(most_agreeing_, agreeing);
  recognised_ += frame.state == ShapeState::estimated || agreeing >= kFewest ? 1 : 0;
}

void SetupMonitor::count_jumps(const Shape* shape, std::uint64_t frame) {
  constexpr double kJump = 0.25;
  if (shape == nullptr || !is_sequence_) return;
  project(*shape);
  if (before_ && *before_ + 1 == frame) {
    const double way = mean_way(before_px_, now_px_);
    ++pairs_;
    if (way > kJump) {
      ++jumps_;
      jumps_sum_ += way;
    }
  }
  before_px_.swap(now_px_);
  before_ = frame;
}

std::vector<SetupMonitor::Finding> SetupMonitor::findings() const {
  std::vector<Finding> found;
  judge_camera(found);
  judge_rejects(found);
  judge_recognition(found);
  judge_jumps(found);
  return found;
}

std::vector<RunWarning> SetupMonitor::warnings() const {
  std::vector<RunWarning> warnings;
  for (Finding& found : findings()) {
    warnings.push_back({"setup", std::move(found.text), found.frames});
  }
  return warnings;
}

std::vector<std::pair<std::string, double>> SetupMonitor::camera() const {
  if (static_cast<std::int64_t>(cameras_.size()) < kFewestFrames) return {};
  return run_figures(cameras_, *host::view_as<Camera>(*camera_));
}

void SetupMonitor::judge_camera(std::vector<Finding>& findings) const {
  for (const CameraFault& fault : faults_) {
    std::string text = fault.text;
    if (fault.is_sure && weakened_ > 0) {
      text += "; frames that are weak for that reason: " + std::to_string(weakened_);
    }
    findings.push_back({fault.kind, std::move(text), static_cast<std::int64_t>(cameras_.size())});
  }
}

void SetupMonitor::judge_rejects(std::vector<Finding>& findings) const {
  if (with_rejects_ < kFewestFrames || 2 * with_rejects_ < rejects_looks_) return;
  const std::string mean = std::to_string(rejects_ / with_rejects_);
  if (2 * rejects_elsewhere_ > rejects_) {
    findings.push_back(
        {"elsewhere",
         "parts of the printed image seem to lie elsewhere than in the texture: " + mean +
             " rejected matches in the mean frame agree with each other, where "
             "none was kept; is the texture that of this object?",
         with_rejects_});
  } else {
    findings.push_back({"second print",
                        "a second print like the texture seems to be in view: " + mean +
                            " rejected matches in the mean frame agree with each other; the "
                            "filter decides which one is followed",
                        with_rejects_});
  }
}

void SetupMonitor::judge_recognition(std::vector<Finding>& findings) const {
  if (with_matches_ < kFewestForRates || 10 * recognised_ > with_matches_) return;
  findings.push_back({"recognition",
                      "the texture was recognised in " + std::to_string(recognised_) + " of " +
                          std::to_string(with_matches_) + " frames" + ", at most " +
                          std::to_string(std::llround(most_agreeing_)) +
                          " matches agreed with a shape: is it that of the object, not mirrored, "
                          "and is the object in view, large and sharp enough?",
                      with_matches_ - recognised_});
}

void SetupMonitor::judge_jumps(std::vector<Finding>& findings) const {
  if (pairs_ < kFewestForRates || 2 * jumps_ < pairs_) return;
  findings.push_back(
      {"jumps",
       "the object moves by " +
           std::to_string(std::llround(100.0 * jumps_sum_ / static_cast<double>(jumps_))) +
           " % of its size from frame to frame, so that it cannot be followed and "
           "is found anew: take more frames a second",
       jumps_});
}

}  // namespace weft
