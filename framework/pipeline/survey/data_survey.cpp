// SPDX-License-Identifier: Apache-2.0
#include "pipeline/survey/data_survey.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/data/catalogue.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/surface_size.hpp>

#include "host/calling/execution_context.hpp"
#include "host/loading/component_checks.hpp"
#include "host/roles/role_rules.hpp"
#include "pipeline/execution/checks.hpp"

namespace weft {
namespace {

using host::Outcome;

template <class RecordType>
std::optional<RecordType> typed_in(const Outcome& outcome, const char* slot) {
  const host::RecordPtr record = outcome.find(slot);
  if (record == nullptr) return std::nullopt;
  auto typed = host::view_as<RecordType>(*record);
  return typed ? std::optional<RecordType>(*std::move(typed)) : std::nullopt;
}

void add_depth(const Array<float>& depth_m, TruthSurvey& truth) {
  std::int64_t known = 0;
  for (std::int64_t i = 0; i < depth_m.dim(0); ++i) {
    for (std::int64_t j = 0; j < depth_m.dim(1); ++j) {
      const double value = depth_m(i, j);
      if (!(value > 0.0)) continue;
      ++known;
      truth.nearest_m = std::min(truth.nearest_m, value);
      truth.furthest_m = std::max(truth.furthest_m, value);
    }
  }
  const auto pixels = static_cast<double>(std::max<std::int64_t>(1, depth_m.size()));
  truth.depth_percent += 100.0 * static_cast<double>(known) / pixels;  // a sum until the end
}

void add_points(const GroundTruth& given, const Camera& camera, TruthSurvey& truth) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  for (std::int64_t i = 0; i < given.count(); ++i) {
    const Eigen::Vector3d point_m = given.points_m.matrix<3>().row(i);
    const Eigen::Vector2d pixel = project(pinhole, point_m);
    truth.points_behind += !(point_m.z() > 0.0);
    truth.points_outside += !(pixel.x() >= -0.5 && pixel.y() >= -0.5 &&
                              pixel.x() <= static_cast<double>(camera.width_px) - 0.5 &&
                              pixel.y() <= static_cast<double>(camera.height_px) - 0.5);
    truth.nearest_m = std::min(truth.nearest_m, point_m.z());
    truth.furthest_m = std::max(truth.furthest_m, point_m.z());
  }
  truth.points += given.count();
}

void add_extent(const Array<double>& points_m, TruthSurvey& truth) {
  constexpr std::int64_t kFewest =
      3;  // points of a surface; one or two may be as close as they like
  if (!points_m.present() || points_m.dim(0) < kFewest) return;
  const Points3 all_m = points_m.matrix<3>();
  const double side_m = (all_m.colwise().maxCoeff() - all_m.colwise().minCoeff()).maxCoeff();
  truth.largest_side_m = std::max(truth.largest_side_m, side_m);
}

void add_truth(const GroundTruth& given, DataSurvey& survey) {
  TruthSurvey& truth = survey.truth[given.kind];
  if (truth.frames == 0) truth.fewest_points = given.count();
  ++truth.frames;
  ++survey.frames_with_truth;
  truth.excluded += given.exclusion.empty() ? 0 : 1;
  truth.fewest_points = std::min(truth.fewest_points, given.count());
  truth.most_points = std::max(truth.most_points, given.count());
  truth.has["faces"] += given.faces.present();
  truth.has["visible"] += given.visible.present();
  truth.has["depth_m"] += given.depth_m.present();
  truth.has["uv_m"] += given.uv_m.present();
  truth.has["cloud_m"] += given.cloud_m.present();
  truth.has["cloud_faces"] += given.cloud_faces.present();
  truth.has["parts"] += given.part_names.present();
  truth.has["match_xy_px"] += given.match_xy_px.present();
  truth.has["match_label"] += given.match_label.present();
  add_points(given, survey.camera, truth);
  add_extent(given.points_m, truth);
  add_extent(given.cloud_m, truth);
  if (given.depth_m.present()) add_depth(given.depth_m, truth);
}

void add_frame(const Outcome& read, DataSurvey& survey) {
  if (const auto image = typed_in<Image>(read, "image")) {
    const bool first = survey.grey + survey.colour == 0;
    if (first) survey.first_stem = image->stem;
    survey.last_stem = image->stem;
    ++(image->pixels.ndim() == 3 ? survey.colour : survey.grey);
  }
  if (const auto time = typed_in<Time>(read, "time")) {
    if (survey.frames == 1) survey.first_s = time->t_s;
    survey.last_s = time->t_s;
  }
  if (const auto matches = typed_in<Correspondences>(read, "correspondences")) {
    survey.matches += matches->count();
  }
  if (const auto truth = typed_in<GroundTruth>(read, "ground_truth")) add_truth(*truth, survey);
}

/// Properties that are not errors, but change what the data can show.
void add_findings(DataSurvey& survey) {
  const std::int64_t without = survey.frames - survey.frames_with_truth;
  const auto find = [&](bool found, const std::string& sentence) {
    if (found) survey.findings.push_back(sentence);
  };
  find(survey.frames == 0, "there are no frames");
  find(survey.frames > 0 && survey.frames_with_truth == 0,
       "no frame has truth: errors cannot be measured");
  find(survey.frames_with_truth > 0 && without > 0,
       std::to_string(without) + " of " + std::to_string(survey.frames) + " frames have no truth");
  find(survey.grey > 0 && survey.colour > 0, "some images are grey and some have colours");
  for (auto& [kind, truth] : survey.truth) {
    const std::string name = kind.empty() ? "truth" : "truth " + kind;
    const std::int64_t depths = truth.has["depth_m"];
    if (depths > 0) truth.depth_percent /= static_cast<double>(depths);
    find(truth.points_behind > 0,
         name + ": " + std::to_string(truth.points_behind) + " points behind the camera");
    find(truth.points_outside > truth.points_behind,
         name + ": " + std::to_string(truth.points_outside - truth.points_behind) + " of " +
             std::to_string(truth.points) + " points lie outside the image");
    find(depths > 0 && depths < truth.frames,
         name + ": " + std::to_string(truth.frames - depths) + " frames have no depth image");
    find(truth.fewest_points != truth.most_points, name + ": frames differ in their points");
    if (truth.largest_side_m == 0.0) continue;
    const std::string doubt =
        size_doubt(truth.largest_side_m, truth.has["cloud_m"] > 0 ? "truth_unit_m" : "");
    find(!doubt.empty(), name + ": " + doubt);
  }
}

/// Warnings of `weft check` about the template that the file with the source names, including its
/// size.
void add_template(const DataLayout& layout, const host::Registry& registry, DataSurvey& survey) {
  const yaml::Node* use = layout.templ.find("use");
  if (use == nullptr) return;
  std::vector<yaml::Problem> problems, warnings;
  const auto spec = host::resolve_component(
      registry, *use, layout.templ.find("params"),
      host::PathRules::of_process({layout.folder}, layout.folder), problems);
  if (spec) host::ComponentChecks().ask(*spec, problems, &warnings);
  for (const auto* found : {&problems, &warnings}) {
    for (const yaml::Problem& each : *found) {
      survey.findings.push_back("template: " + each.message);
    }
  }
}

Error problem_of(const std::vector<yaml::Problem>& problems, const DataLayout& layout) {
  return {Errc::invalid_value, problems.front().message, layout.folder};
}

}  // namespace

Result<DataSurvey> survey_data(const DataLayout& layout, const host::Registry& registry,
                               const std::atomic<bool>& cancel) {
  std::vector<yaml::Problem> problems;
  const auto spec = host::resolve_component(
      registry, *layout.source.find("use"), layout.source.find("params"),
      host::PathRules::of_process({layout.folder}, layout.folder), problems);
  if (!spec) return problem_of(problems, layout);
  DataSurvey survey;
  host::ExecutionContext context(
      0, [&](const std::string&, int, const std::string& text, std::uint64_t frame) {
        if (frame == host::kOfflineFrame) survey.findings.push_back(text);
      });
  context.cancellation().watch([&] { return cancel.load(); });
  const auto source = context.instantiate(*spec, "sources");
  if (!source) return source.error();
  const Outcome opened = context.call(**source, kOpenSource, {}, host::kOfflineFrame);
  if (!opened.usable()) return opened.error;
  if (auto valid = check_camera(*opened.find("camera")); !valid) {
    return Error{valid.error().code, valid.error().message, spec->component().id};
  }
  const Outcome counted = context.call(**source, kCountFrames, {}, host::kOfflineFrame);
  if (!counted.usable()) return counted.error;
  survey.kind = layout.kind;
  survey.source = spec->component().id;
  survey.camera = *typed_in<Camera>(opened, "camera");
  survey.assumed = CameraAssumption::of(survey.camera);
  const std::int64_t count = typed_in<Count>(counted, "count")->frames;
  for (std::int64_t i = 0; (count < 0 || i < count) && !cancel.load(); ++i) {
    const Outcome read = context.call(**source, kReadFrame, {}, static_cast<std::uint64_t>(i));
    if (read.status == WEFT_END || (!read.usable() && cancel.load())) break;
    ++survey.frames;
    if (read.usable()) add_frame(read, survey);
    if (!read.usable()) {
      survey.failures.push_back("frame " + std::to_string(i) + ": " + read.error.message);
    }
  }
  add_findings(survey);
  add_template(layout, registry, survey);
  return survey;
}

}  // namespace weft
