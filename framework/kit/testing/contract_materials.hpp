// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/testing/contract_scene.hpp"

/// Parts of the scenes of the contract.
namespace weft::testing {

/// Discs of random grey levels: corners, blobs and edges for any detector.
void draw_discs(Array<std::uint8_t>& pixels, Rng& rng);

/// Adds all arrays of matches that follow from descriptors.
void describe(LabelledMatches& drawn, Rng& rng);

/// Keypoints at these places, whose descriptors are those of any other call with the same `rng`,
/// but for the noise, in grey levels.
Keypoints make_keypoints(const Points2View& places, Rng rng, double noise, Rng noise_rng);

/// The same keypoints with a bit for each pair of neighbouring numbers instead of the numbers.
Keypoints with_bits(Keypoints keypoints);

/// The map from texture to image, with its derivatives, at the template's vertices.
WarpSamples sample_truth(const Template& templ, const Camera& camera,
                         const DevelopableSheet& sheet);

/// The exact mask of the bent template: the foreground is the share of each pixel that it covers.
ObjectMask mask_of(const Template& templ, const Camera& camera, const DevelopableSheet& sheet);

/// Adds template point and depth of each pixel, by Newton's method from one pixel to the next.
void add_maps(const Template& templ, const Camera& camera, const DevelopableSheet& sheet,
              GroundTruth& truth);

Shape shape_at(const Points3& vertices_m);
Visibility all_visible(std::int64_t count);
GroundTruth truth_of(const Template& templ, const Points3& vertices_m);

/// The first and the last vertex, within 5 mm.
KnownPoints known_corners(const Points3& vertices_m);

}  // namespace weft::testing
