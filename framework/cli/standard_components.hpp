// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/ablation/plan/plan.hpp"
#include "pipeline/survey/data_layout.hpp"

namespace weft::cli {

/// The plugins that this program uses by default.
inline FileSources standard_sources() {
  return {.images = "sources/images", .matches = "sources/matches", .video = "sources/video"};
}

inline lab::Helpers standard_helpers() {
  return {.frames_source = "sources/images",
          .picture_sink =
              "{use: sinks/overlay, params: {path: worst.avi, view: image, draw_matches: true, "
              "stills_every: 1, stills_width_px: 320}}"};
}

/// Keypoints and matches as in the default pipeline, in YAML.
struct StandardFeatures {
  const char* detector;
  const char* matcher;
};

inline StandardFeatures standard_features() {
  return {.detector = "{use: detectors/sift_fast}",
          .matcher = "{use: matchers/descriptor, params: {direction: image_to_template}}"};
}

/// The pipeline over which `weft track` lays its frames and its object.
inline const char* tracking_pipeline() { return "demo.yaml"; }

/// Components that --photo stands for.
inline const char* photo_template() { return "templates/photo"; }

/// The sink whose images a report shows beside the flat print.
inline const char* unwarping_sink() { return "sinks/unwarped"; }

/// Components that --flat-reference stands for.
inline const char* registration_pass() { return "passes/flat_reference"; }

}  // namespace weft::cli
