// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>
#include <weft/data/visibility.hpp>
#include <weft/data/warp.hpp>

namespace weft::salient_cells {

/// Which faces and points to trust.
struct Rules {
  int min_matches_per_cell = 1;  ///< [] kept matches that make a face salient
  double reach = 0.0;            ///< [] share of the template's diagonal, see find_cells()
  bool count_all = false;        ///< matches beyond min_matches_per_cell count too
  bool reject_folded = false;    ///< faces that the warp folds or squeezes are not salient
  double image_margin = 0.05;    ///< [] share of the image's size that a point may lie outside
};

/// The omitted matches, by reason.
struct Dropped {
  int not_evaluated = 0;  ///< [] the warp had to extrapolate there or is not finite
  int outside = 0;        ///< [] beyond the image and its margin
  int hidden = 0;         ///< [] hidden by the visibility
};

/// The faces that are salient, and how many kept matches lie in each.
struct Cells {
  std::vector<int> matches;           ///< [F] kept matches in each face, or near it
  std::vector<std::uint8_t> salient;  ///< [F] 1 where a face is salient
  int matches_without_face = 0;       ///< [] kept, but on no face
  int folded_faces = 0;               ///< [] rejected for that reason
  double coverage = 0.0;              ///< [] area of the salient faces / area of all, at rest

  int count() const;
};

/// The faces that contain enough matches. With a reach, a face also has the matches whose place in
/// the texture is within it of the middle of the face. The saliency of a place therefore does not
/// depend on the resolution of the mesh. They are counted only up to the needed number. Fails on a
/// face index that the template does not have. `warped` holds the template's vertices in the image.
Result<Cells> find_cells(const Template& templ, const Correspondences& correspondences,
                         const WarpSamples& warped, const Rules& rules);

/// One salient vertex.
struct SalientVertex {
  std::int32_t vertex = 0;  ///< []
  std::int32_t face = 0;    ///< [] the salient face of lowest index that has it
  int corner = 0;           ///< [] its place in that face, 0 to 2
  int matches = 0;          ///< [] kept matches in its salient faces
};

/// The vertices of salient faces whose warped position can be used, ascending.
std::vector<SalientVertex> find_vertices(const Template& templ, const Camera& camera,
                                         const Cells& cells, const WarpSamples& warped,
                                         const std::optional<Visibility>& visibility,
                                         const Rules& rules, Dropped& dropped);

/// The kept matches in salient faces that can be used themselves, ascending.
std::vector<std::int64_t> find_matches(const Template& templ, const Camera& camera,
                                       const Cells& cells, const Correspondences& correspondences,
                                       const std::optional<Visibility>& visibility,
                                       const Rules& rules, Dropped& dropped);

}  // namespace weft::salient_cells
