// SPDX-License-Identifier: Apache-2.0
#include "common/sift_parameters.hpp"

namespace weft::detectors {
namespace {

void read_all_but_upsample(SiftParameters& to, Params& p, const char* sigma_help) {
  p.prominent().read(
      "max_keypoints", to.max_keypoints, "", {0, 1000000},
      "maximum number of keypoints, the strongest ones spread over the image; 0: no limit");
  p.read("buckets", to.buckets, "", {1, 256},
         "number of cells per side over which max_keypoints is spread; 1: no spreading");
  p.read("octave_layers", to.settings.octave_layers, "", {1, 10}, "number of scales per octave");
  p.read("contrast_threshold", to.settings.contrast_threshold, "", {0, 1},
         "minimum contrast of a blob, as a share of the range of grey levels; divided by "
         "octave_layers");
  p.read("edge_threshold", to.settings.edge_threshold, "", {1, 1000},
         "maximum ratio of the principal curvatures; larger values accept more edges");
  p.read("sigma_px", to.settings.sigma_px, "px", {1, 10}, sigma_help);
}

}  // namespace

void SiftParameters::read(Params& p) {
  read_all_but_upsample(
      *this, p, "standard deviation of the blur of the first scale, in px of the first octave");
  p.read("upsample", settings.upsample,
         "enlargement of the image by two before detection; finds smaller blobs at four times the "
         "cost");
}

void SiftParameters::read_without_upsample(Params& p) {
  read_all_but_upsample(
      *this, p, "standard deviation of the blur of the first scale, in px of the doubled image");
}

}  // namespace weft::detectors
