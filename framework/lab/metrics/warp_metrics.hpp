// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/data/warp.hpp>
#include <weft/geometry/camera_model.hpp>

#include "lab/metrics/field.hpp"

namespace weft {
class TruthMap;
}

namespace weft::lab {

/// A warp of one frame against the truth: |M_hat_v - M_G,v| over vertices of the mesh whose true
/// image is known. Salient are the vertices of faces in which a match was kept; the others follow
/// from the warp's smoothness alone.
struct WarpErrors {
  double salient_px = std::numeric_limits<double>::quiet_NaN();  ///< [] px, mean
  double other_px = std::numeric_limits<double>::quiet_NaN();    ///< [] px, mean
  std::int64_t salient = 0, other = 0;                           ///< [] vertices

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"salient_px", "mean distance of salient vertices to their true images", kLower},
          self.salient_px);
    visit({"salient_vertices", "corners of a face in which a match was kept"}, self.salient);
    visit({"other_px", "mean distance of the other vertices", kLower}, self.other_px);
    visit({"other_vertices", "which follow from the warp's smoothness alone"}, self.other);
  }
};

/// Means over the frames in which they are defined.
struct WarpMetrics {
  std::string stage;
  std::int64_t frames = 0;                                       ///< [] frames with a warp
  std::int64_t salient = 0, other = 0;                           ///< [] vertices
  double salient_px = std::numeric_limits<double>::quiet_NaN();  ///< [] px
  double other_px = std::numeric_limits<double>::quiet_NaN();    ///< [] px

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit({"stage", "name of the warp's stage", {}, "warp"}, self.stage);
    visit({"frames", "with a warp and a known truth", {}, "frames"}, self.frames);
    visit({"salient_px", "mean distance of salient vertices to their true images", kLower,
           "salient px"},
          self.salient_px);
    visit({"salient_vertices", "corners of a face in which a match was kept", {}, "vertices"},
          self.salient);
    visit({"other_px", "mean distance of the other vertices", kLower, "other px"}, self.other_px);
    visit({"other_vertices", "which follow from the warp's smoothness alone", {}, "vertices"},
          self.other);
  }
};

/// `samples` has one entry for each vertex of the template, `kept` one for each match.
WarpErrors warp_errors(const WarpSamples& samples, const Correspondences& matches,
                       const Array<std::uint8_t>& kept, const Template& sheet,
                       const TruthMap& truth, const Pinhole& camera);

/// Errors of one stage over its frames.
WarpMetrics summarise_warp(const std::string& stage, const std::vector<WarpErrors>& frames);

}  // namespace weft::lab
