// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>

namespace weft::lab {

/// A frame as a viewer draws it; points are triples one after the other, m, camera frame.
struct ViewFrame {
  std::uint64_t frame = 0;  ///< [] index from 0
  std::string state;
  std::vector<float> vertices;  ///< [V,3] of the estimate, or nothing
  std::vector<float> truth;     ///< [T,3] true points
  std::vector<float> placed;    ///< [T,3] the same points on the estimate, NaN where there is none
};

struct CellView {
  std::vector<std::uint32_t> faces;  ///< [F,3] of the template
  std::vector<ViewFrame> frames;     ///< ascending
};

/// The maximum size of a cell's view; frames and points beyond it are omitted at even intervals.
struct ViewLimits {
  std::size_t frames = 60;         ///< [] maximum number of frames
  std::size_t truth_points = 300;  ///< [] maximum number of true points per frame
};

/// The records of one frame, which borrow from others.
struct FrameShapes {
  std::optional<Shape> shape;
  std::optional<GroundTruth> truth;
};

/// Frames for a viewer, with the faces of the template. Fails if a shape has another mesh.
Result<CellView> view_of(const Template& sheet, const std::map<std::uint64_t, FrameShapes>& frames,
                         const ViewLimits& limits);

/// Reads the shapes that an ablation kept of a cell: `shapes.npz` in its folder. A view without
/// frames where there is no such file; an error where it is damaged.
Result<CellView> read_cell_view(const std::string& folder, const ViewLimits& limits);

struct Thumbnail {
  std::uint64_t frame = 0;  ///< [] index from 0
  std::string type;         ///< media type, such as "image/png"
  std::string bytes;
};

/// The thumbnails of worst frames in a cell's folder, in the order of their frames.
std::vector<Thumbnail> read_thumbnails(const std::string& folder);

}  // namespace weft::lab
