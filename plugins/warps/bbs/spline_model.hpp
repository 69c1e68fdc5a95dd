// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/result.hpp>
#include <weft/data/warp.hpp>
#include <weft/geometry/bspline_basis.hpp>
#include <weft/geometry/types.hpp>

namespace weft::bbs {

/// A fitted spline.
struct SplineModel {
  SplineDomain domain;
  Points2 control_px;  ///< [nu*nv,2] px of the image, v fastest
};

/// Fills `domain_px`, "model.grid" [2] (nu, nv) and "model.control" [nu*nv,2] of a warp.
void write_model(const SplineDomain& domain, const Points2& control_px, Warp& warp);

/// The model of a warp record. invalid_data when it is not one of write_model().
Result<SplineModel> read_model(const Warp& warp);

/// Values and derivatives at points. Outside the domain the spline is continued linearly from its
/// border and `valid` is 0, as it is where a point or a value is not finite.
Result<WarpSamples> evaluate_model(const SplineModel& model, const Points& points);

}  // namespace weft::bbs
