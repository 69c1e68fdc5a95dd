// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>

#include "pipeline/survey/residual_field.hpp"
#include "pipeline/survey/rest_pose.hpp"

namespace weft {

/// How a mesh may have been mirrored on its way into a file: not at all; its texture coordinates
/// left to right, upside down or both; its vertices in space.
enum class Flip { none, u, v, both, space };
const char* to_string(Flip flip);

/// How well the object at rest explains a frame's matches once it is mirrored so.
struct FlippedFit {
  Flip flip = Flip::none;
  std::int64_t matches = 0;  ///< [] that lie on the mesh
  RestPose pose;
};

/// How the matches of photographs are distributed over the charts of the texture. A chart is judged
/// if it would have 8 matches, were all matches distributed evenly over what the photographs show
/// of the object at rest. It is unmatched if it has less than a tenth of them. Charts that face
/// away or are hidden are not judged.
struct ChartMatches {
  int judged = 0, unmatched = 0;  ///< [] numbers of charts
  double unmatched_share =
      0.0;  ///< [] of the visible part of the object, by its area in the images
};

/// Evidence of a frame that shows the object about at rest about its template.
struct FirstLook {
  std::int64_t kept = 0;           ///< [] matches that filters left
  std::int64_t kept_mirrored = 0;  ///< [] the same with the image of the texture mirrored
  double size_px = 0.0;            ///< [] diagonal of the box around those matches
  std::vector<FlippedFit> fits;    ///< as given first; without those that no pose explains
  /// The same with the image of the texture mirrored.
  std::vector<FlippedFit> fits_mirrored = {};
  /// Residuals of the fit as given, smooth in the texture.
  std::optional<ResidualField> field = {};
  /// Only for a texture of several charts.
  std::optional<ChartMatches> charts = {};
};

/// The pose of the object at rest by the kept matches; nothing where no pose explains them.
std::optional<RestPose> pose_at_rest(const Template& templ, const Camera& camera,
                                     const Correspondences& matches);

/// The distribution of the kept matches of photographs, which show the object about at rest.
/// Nothing for a texture of one chart, and where no pose explains the matches.
std::optional<ChartMatches> chart_matches(const Template& templ, const Camera& camera,
                                          const std::vector<Correspondences>& photographs);

/// Fits the object to the kept matches, mirrored in each way.
std::vector<FlippedFit> fit_flipped(const Template& templ, const Camera& camera,
                                    const Correspondences& matches);

/// The same object with its image, and all in it, mirrored left to right.
Template mirrored(const Template& templ);

/// Sentences that name each fault and what mends it; empty where there is none.
std::vector<std::string> faults_of(const FirstLook& look);

/// The same of what is doubtful about a template without faults.
std::vector<std::string> doubts_of(const FirstLook& look);

/// How far texture coordinates are off at matches with the object at rest in a frame, once the pose
/// is the one that spreads the errors most evenly. Nothing where no pose explains the matches.
std::optional<TextureResiduals> residuals_at_rest(const Template& templ, const Camera& camera,
                                                  const Correspondences& matches);

}  // namespace weft
