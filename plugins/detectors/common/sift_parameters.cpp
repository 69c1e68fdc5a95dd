// SPDX-License-Identifier: Apache-2.0
#include "common/sift_parameters.hpp"

namespace weft::detectors {
namespace {

void read_all_but_upsample(SiftParameters& to, Params& p, const char* sigma_help) {
  p.read("max_keypoints", to.max_keypoints, "", {0, 1000000},
         "strongest keypoints kept, spread over the image; 0 keeps all");
  p.read("buckets", to.buckets, "", {1, 256},
         "cells per side over which the cap spreads the keypoints; 1 does not spread them");
  p.read("octave_layers", to.settings.octave_layers, "", {1, 10}, "scales per octave");
  p.read("contrast_threshold", to.settings.contrast_threshold, "", {0, 1},
         "weakest blob, as a part of the range of grey levels; divided by octave_layers");
  p.read("edge_threshold", to.settings.edge_threshold, "", {1, 1000},
         "largest ratio of principal curvatures; larger lets more edges pass");
  p.read("sigma_px", to.settings.sigma_px, "px", {1, 10}, sigma_help);
}

}  // namespace

void SiftParameters::read(Params& p) {
  read_all_but_upsample(*this, p, "blur of the first scale, in px of the first octave");
  p.read("upsample", settings.upsample,
         "begin with the image enlarged twice: finds smaller blobs for four times the work");
}

void SiftParameters::read_without_upsample(Params& p) {
  read_all_but_upsample(*this, p, "blur of the first scale, in the doubled image");
}

}  // namespace weft::detectors
