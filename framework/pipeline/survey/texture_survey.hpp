// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/data/correspondences.hpp>
#include <weft/data/keypoints.hpp>

#include "host/calling/execution_context.hpp"
#include "pipeline/survey/template_survey.hpp"

namespace weft {

/// Suitability of a template's texture.
struct TextureSurvey {
  std::int64_t keypoints = 0;         ///< [] of the texture, on the object
  std::int64_t expected_matches = 0;  ///< [] correct ones, in a view of it
  double view_px = 0.0;               ///< [] px, the longer side of the object in that view
  double twin_share = 0.0;            ///< [] of the keypoints, that have a twin elsewhere
  double gap_mm = 0.0;                ///< [] mm, widest circle without an expected match
  Eigen::Vector2d gap_px = Eigen::Vector2d::Zero();  ///< [2] px of the texture, its middle
  Correspondences
      twins;  ///< each keypoint and, as image_px, that elsewhere which looks most like it
};

/// Detects the texture's keypoints, matches them with a view of it (see view_of_texture()), and
/// counts the inliers within 2 px. `numbers` are the template's. Keypoints are twins if the
/// matcher's ratio test cannot distinguish them: their descriptors are closer than the median
/// inlier distance divided by its ratio, 0.8.
Result<TextureSurvey> survey_texture(const host::Record& templ, const TemplateSurvey& numbers,
                                     const host::ComponentSpec& detector,
                                     const host::ComponentSpec& matcher);

/// Each keypoint with its most similar one (RootSIFT, Arandjelovic and Zisserman 2012) beyond four
/// times the larger of their scales. `kept` is set if their descriptor distance is below
/// `twin_distance`. Empty for binary descriptors.
Correspondences look_alikes(const Keypoints& points, double twin_distance);

/// Sentences about places where the texture is poor or repeats itself; empty if there are none.
std::vector<std::string> warnings_of(const TextureSurvey& texture, const TemplateSurvey& numbers);

}  // namespace weft
