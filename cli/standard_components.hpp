// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ablation/plan/plan.hpp"
#include "pipeline/survey/data_layout.hpp"

namespace weft::cli {

/// The plugins that this program uses where nothing else says which.
inline FileSources standard_sources() {
  return {.images = "sources/images", .matches = "sources/matches", .video = "sources/video"};
}

inline evaluation::Helpers standard_helpers() {
  return {.frames_source = "sources/images",
          .picture_sink =
              "{use: sinks/overlay, params: {path: worst.avi, view: image, draw_matches: true, "
              "stills_every: 1, stills_width_px: 320}}"};
}

}  // namespace weft::cli
