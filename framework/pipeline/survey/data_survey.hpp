// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>
#include <weft/data/camera.hpp>

#include "host/loading/registry.hpp"
#include "pipeline/survey/data_layout.hpp"

namespace weft {

/// Truth of one kind.
struct TruthSurvey {
  std::int64_t frames = 0;                          ///< [] frames with truth of this kind
  std::int64_t excluded = 0;                        ///< [] frames that are excluded from means
  std::int64_t fewest_points = 0, most_points = 0;  ///< [] of a frame
  std::int64_t points = 0;                          ///< [] true points over all frames
  std::int64_t points_outside = 0;          ///< [] of these, whose image is outside the frame's
  std::int64_t points_behind = 0;           ///< [] of these, not in front of the camera
  std::map<std::string, std::int64_t> has;  ///< frames with faces, visible, depth_m, uv_m ...
  double depth_percent = 0.0;               ///< [] pixels with a depth, mean over frames with some
  double nearest_m = std::numeric_limits<double>::infinity();  ///< [] m, of depth and points
  double furthest_m = 0.0;                                     ///< [] m
  double largest_side_m = 0.0;  ///< [] m, of the box around the points of a frame; 0: no points
};

/// Contents of the data at a path.
struct DataSurvey {
  std::string kind;    ///< kind of the layout
  std::string source;  ///< component that reads them
  Camera camera;
  std::optional<CameraAssumption> assumed;   ///< for a camera without a calibration
  std::int64_t frames = 0;                   ///< [] number of frames
  std::int64_t grey = 0, colour = 0;         ///< [] frames with such an image
  std::int64_t matches = 0;                  ///< [] of the source itself, over all frames
  std::string first_stem, last_stem;         ///< [] of images
  double first_s = 0.0, last_s = 0.0;        ///< [] s
  std::map<std::string, TruthSurvey> truth;  ///< by kind
  std::int64_t frames_with_truth = 0;        ///< [] frames with ground truth
  std::vector<std::string> failures;         ///< a sentence a frame that cannot be read
  std::vector<std::string> findings;         ///< warnings and hints for users of the data
};

/// Reads all frames. Fails where the source cannot be made or opened; a frame that cannot be read
/// is counted. Stops early when `cancel` is set.
Result<DataSurvey> survey_data(const DataLayout& layout, const host::Registry& registry,
                               const std::atomic<bool>& cancel);

}  // namespace weft
