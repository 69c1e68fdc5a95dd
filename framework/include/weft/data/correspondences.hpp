// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Matches between the template's texture and the image. Filters mark matches and never drop or
/// reorder them. `kept` is 1 for all matches before the first filter.
///
/// A source or matcher may give only positions on the template, with face -1. It may also give
/// template_xy_m with any template_px. The host then completes template_px, face and barycentrics
/// before any other component reads the record. A match beyond the mesh by more than half of its
/// mean edge keeps face -1. Such a match counts where only its pixels matter. Components that need
/// its position on the surface omit and count it.
struct Correspondences {
  static constexpr const char* kType = "correspondences/1";
  Array<double> template_px;              ///< [N,2] px of the texture
  Array<double> image_px;                 ///< [N,2] px
  Array<std::int32_t> template_keypoint;  ///< [N] index, -1 for none
  Array<std::int32_t> image_keypoint;     ///< [N] index, -1 for none
  Array<std::int32_t> face;    ///< [N] face of the template; -1: beyond the mesh or unknown
  Array<double> barycentrics;  ///< [N,3] weights in that face, sum 1
  Array<double> distance;      ///< [N] distance between the descriptors, unit of the matcher
  Array<double> ratio;         ///< [N] distance divided by the second nearest distance
  Array<double> scale_ratio;   ///< [N] image scale / template scale
  Array<double> angle_difference_rad;  ///< [N] rad, image minus template, in (-pi, pi]
  Array<double> covariance_px2;        ///< [N,2,2] px^2, covariance of image_px
  Array<std::uint8_t> kept;            ///< [N] 1 unless a filter rejected it
  Array<double> score;                 ///< [N] larger is more trusted; 1 before the first filter
  Array<double> confidence;  ///< [] probability that the kept matches show the object, from filters
  Array<double> template_xy_m;  ///< [N,2] m, m_per_px * (u,v); the host derives template_px from it
  Diagnostics diag = {};        ///< diagnostics of the matcher; filters have their own
  Others others = {};           ///< further arrays of the record

  std::int64_t count() const { return template_px.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.template_px, Field{"template_px", "N,2", "px of the texture", "in the template"});
    visit(self.image_px, Field{"image_px", "N,2", "px", "in the image"});
    visit(self.template_keypoint,
          Field{"template_keypoint", "N", "index", "template keypoint, -1 for none", true});
    visit(self.image_keypoint,
          Field{"image_keypoint", "N", "index", "image keypoint, -1 for none", true});
    visit(self.face,
          Field{"face", "N", "index", "face of the template, -1: beyond it or not known"});
    visit(self.barycentrics, Field{"barycentrics", "N,3", "", "weights in that face, sum 1"});
    visit(self.distance, Field{"distance", "N", "", "between the descriptors", true});
    visit(self.ratio, Field{"ratio", "N", "", "to the second nearest distance", true});
    visit(self.scale_ratio, Field{"scale_ratio", "N", "", "image scale / template scale", true});
    visit(self.angle_difference_rad,
          Field{"angle_difference_rad", "N", "rad", "image minus template", true});
    visit(self.covariance_px2, Field{"covariance_px2", "N,2,2", "px^2", "of image_px", true});
    visit(self.kept, Field{"kept", "N", "0 or 1", "1 unless a filter rejected it"});
    visit(self.score, Field{"score", "N", "", "larger is more trusted"});
    visit(self.confidence,
          Field{"confidence", "", "0 to 1",
                "least confidence that a filter stated for the matches it kept", true});
    visit(self.template_xy_m, Field{"template_xy_m", "N,2", "m",
                                    "m_per_px * (u,v); the host makes template_px of it", true});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

/// A filter's verdict on each match.
struct InlierMask {
  static constexpr const char* kType = "inlier_mask/1";
  Array<std::uint8_t> kept;  ///< [N] 1 for a match that is kept
  Array<double> score;       ///< [N] larger is more trusted
  Diagnostics diag;
  Array<double> confidence = {};  ///< [] probability that the kept matches show the object
  Others others = {};             ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.kept, Field{"kept", "N", "0 or 1", "1 for a match that is kept"});
    visit(self.score, Field{"score", "N", "", "larger is more trusted"});
    visit(self.confidence, Field{"confidence", "", "0 to 1",
                                 "probability that the kept matches show the object", true});
    visit(self.diag, Field{"diag.*", "*", "", "evidence", true});
  }
};

/// Weight of each match in a fit.
struct Weights {
  static constexpr const char* kType = "weights/1";
  Array<double> weight;  ///< [N] >= 0
  Others others = {};    ///< further arrays of the record

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.weight, Field{"weight", "N", "", "not negative"});
  }
};

}  // namespace weft
