// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/keypoints.hpp>
#include <weft/data/known_points.hpp>
#include <weft/data/run_report.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/data/visibility.hpp>
#include <weft/data/warp.hpp>
#include <weft/testing/host_record.hpp>
#include <weft/testing/role_contract.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::testing {

/// One frame of a bent surface with a value for every input that a role may request, except `warp`.
struct Scene {
  Camera camera;
  Template templ;
  Image image;
  Region region;
  ObjectMask object_mask;
  Time time;
  Keypoints keypoints, template_keypoints;
  LabelledMatches matches;
  Weights weights;
  WarpSamples warp_samples;
  Sightlines sightlines;
  Visibility visibility;
  Shape shape;
  KnownPoints known_points;
  GroundTruth ground_truth;
  FrameReport frame_report;
  RunSettings run_settings;

  /// Keeps only the matches of these rows, with their sightlines and truth.
  void take_matches(const std::vector<std::int64_t>& rows);
  /// Replaces all matches and sightlines by ones at these vertices.
  void match_vertices(const std::vector<std::int64_t>& vertices);
  /// Rejects all matches, which leaves no sightlines either.
  void reject_matches();
  /// Removes the faces of all matches.
  void leave_the_mesh();

  /// Null where there is none for this input, or where it is no legal record.
  HostRecord record(std::string_view slot) const;

  /// Makes sightlines, weights and truth those of the matches.
  void follow_matches();
};

/// Scene `number`; all of a seed have the same template and camera.
Scene make_scene(int number, std::uint64_t seed = kContractSeed);

/// The same with other matches, generated with the settings `draw`; `round` makes each draw
/// different.
Scene make_scene(int number, const MatchSpec& draw, int round = 0,
                 std::uint64_t seed = kContractSeed);

}  // namespace weft::testing
