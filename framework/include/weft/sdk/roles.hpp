// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/sdk/detector.hpp>
#include <weft/sdk/filter.hpp>
#include <weft/sdk/matcher.hpp>
#include <weft/sdk/pass.hpp>
#include <weft/sdk/sink.hpp>
#include <weft/sdk/solver.hpp>
#include <weft/sdk/source.hpp>
#include <weft/sdk/template_builder.hpp>
#include <weft/sdk/warp_model.hpp>

namespace weft {

/// All roles, in the order of the data flow: method, inputs -> outputs. An asterisk marks inputs
/// and outputs of every use; see docs/records.md.
///   sources open: -> camera*
///   sources count: -> count*
///   sources read: -> image, time, known_points, ground_truth, correspondences, region, object_mask
///   templates build: -> template*
///   detectors detect: image*, region -> keypoints*
///   matchers match: keypoints, template_keypoints, correspondences (list), image, template,
///       camera, shape, previous.image, previous.correspondences, previous.shape ->
///       correspondences*
///   filters filter: correspondences*, template, camera, previous.shape, ground_truth ->
///       inlier_mask*
///   warps fit: correspondences*, template*, weights -> warp*
///   warps evaluate: warp*, points* -> warp_samples*
///   passes run: template*, camera*, image, warp, warp_samples, correspondences, shape, visibility,
///       object_mask, previous.shape, previous.visibility -> sightlines, visibility, region,
///       registration, object_mask
///   solvers solve: template*, camera*, sightlines, correspondences, warp, image, visibility,
///       known_points, object_mask, previous.shape -> shape*
///   sinks write: image, camera, time, template, keypoints, correspondences, warp, warp_samples,
///       sightlines, visibility, shape, other_shape, ground_truth, frame_report, run_settings
inline std::vector<Role> all_roles() {
  return {Source::role(),  TemplateBuilder::role(), Detector::role(),
          Matcher::role(), Filter::role(),          WarpModel::role(),
          Pass::role(),    Solver::role(),          Sink::role()};
}

}  // namespace weft
