// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "host/records/record.hpp"

namespace weft {

/// The largest template that the stages support, in vertices: a grid of 500 x 500. See
/// docs/templates.md for the measurements.
inline constexpr std::int64_t kMostTemplateVertices = 250'000;

/// Fails unless a template can be used: not too many vertices, indices in range, no folded or
/// degenerate faces, sizes agree, the welding and the tetrahedra belong to the surface.
Result<void> check_template(const host::Record& templ);

/// Why the size of a template that was checked is doubtful; mostly empty. `length` is the parameter
/// that decides it, or empty.
std::string size_doubt_of(const host::Record& templ, const std::string& length);

/// Fails if no camera can have these parameters, see camera_mistake().
Result<void> check_camera(const host::Record& camera);

/// Checks that only the host can do on a record of a stage or source. Indices of vertices and faces
/// are the template's, images have the camera's size, and a solver's shape is estimated or weak. A
/// shape that reaches behind the camera is no_result.
Result<void> check_fits(const host::Record& record, const host::Record& templ,
                        const host::Record& camera);

}  // namespace weft
