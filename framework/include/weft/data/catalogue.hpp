// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/keypoints.hpp>
#include <weft/data/known_points.hpp>
#include <weft/data/run_report.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/data/template.hpp>
#include <weft/data/visibility.hpp>
#include <weft/data/warp.hpp>

namespace weft {

/// Calls visit(std::type_identity<RecordType>) for each record type, in the order of production.
template <class Visit>
void for_each_record_type(Visit&& visit) {
  const auto each = [&]<class... RecordType>() { (visit(std::type_identity<RecordType>{}), ...); };
  each.template
  operator()<Image, Time, Camera, Region, ObjectMask, Template, Keypoints, Correspondences, Weights,
             InlierMask, Warp, Points, WarpSamples, Sightlines, Visibility, KnownPoints, Shape,
             Registration, GroundTruth, Count, FrameReport, RunSettings>();
}

}  // namespace weft
