// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/record.hpp>

namespace weft {

/// Distinctive points of an image or of a template's texture with their descriptors.
struct Keypoints {
  static constexpr const char* kType = "keypoints/1";
  Array<double> xy_px;         ///< [K,2] px, pixel centres at integers
  Array<double> scale_px;      ///< [K] px, sigma of the detected blob or an equivalent scale
  Array<double> angle_rad;     ///< [K] rad, clockwise in the image from +x
  Array<double> response;      ///< [K] strength, in the detector's unit
  Array<std::int32_t> octave;  ///< [K] pyramid level of the detector
  std::string metric;          ///< [n] "l2" or "hamming"
  Array<float> descriptors;    ///< [K,D] descriptors for metric l2
  Array<std::uint8_t> binary_descriptors;  ///< [K,B] descriptors for metric hamming, bytes
  Array<std::int32_t> face;                ///< [K] face of the template, -1 for none
  Array<double> barycentrics;              ///< [K,3] weights in that face, sum 1
  std::uint64_t revision = 0;              ///< equal only for equal content; 0: unknown
  Others others = {};                      ///< further arrays of the record

  std::int64_t count() const { return xy_px.rows(); }

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(self.xy_px, Field{"xy_px", "K,2", "px", "positions"});
    visit(self.scale_px, Field{"scale_px", "K", "px", "sigma of the detected blob"});
    visit(self.angle_rad, Field{"angle_rad", "K", "rad", "orientation, clockwise from +x"});
    visit(self.response, Field{"response", "K", "", "strength, the detector's own unit"});
    visit(self.octave, Field{"octave", "K", "", "pyramid level"});
    visit(self.metric, Field{"metric", "*", "", "l2 or hamming"});
    visit(self.descriptors,
          Field{"descriptors", "K,D", "", "descriptors for metric l2", true, false, true});
    visit(self.binary_descriptors, Field{"binary_descriptors", "K,B", "",
                                         "descriptors for metric hamming", true, false, true});
    visit(self.face, Field{"face", "K", "index", "face of the template, -1 for none", true});
    visit(self.barycentrics, Field{"barycentrics", "K,3", "", "weights in that face", true});
  }
};

}  // namespace weft
