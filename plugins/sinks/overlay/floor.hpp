// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <weft/geometry/types.hpp>

#include "orbit.hpp"

namespace weft::overlay {

/// [m] between the lines of the floor below an object of this radius: 1, 2 or 5 times a power of
/// ten, three to eight lines a radius.
double floor_step_m(double radius_m);

/// "5 cm", "20 mm", "1 m".
std::string length_text(double length_m);

/// Draws a level floor at y = `floor_m` around the middle: lines at multiples of `step_m` along x
/// and z of the real camera, which fade outwards.
void draw_floor(cv::Mat& canvas, const Orbit& orbit, double floor_m, double radius_m,
                double step_m);

/// Darkens what the mesh covers of the floor, seen from above.
void draw_shadow(cv::Mat& canvas, const Orbit& orbit, double floor_m, const Points3View& vertices_m,
                 const FacesView& faces);

}  // namespace weft::overlay
