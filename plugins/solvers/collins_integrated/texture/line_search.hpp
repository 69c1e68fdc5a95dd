// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>
#include <weft/data/template.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/types.hpp>

#include "common/pictures/picture.hpp"
#include "samples.hpp"

namespace weft::collins_integrated {

/// The result of a search at a sample.
enum class Look : std::uint8_t {
  hidden,   ///< its face shows its back, is seen from the side or is behind the camera
  outside,  ///< its patch reaches beyond the image or the object
  flat,     ///< its patch has no edge, at this size
  unlike,   ///< nothing on the line resembles its patch, or what does is at an end of it
  found,
};

/// A sample in the image.
struct Sighting {
  Look look = Look::hidden;
  Eigen::Vector2d seen_px = Eigen::Vector2d::Zero();  ///< [2] px of the image: found here ...
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();   ///< [2] unit: ... along this direction
  float zncc = 0.0F;                                  ///< [] -1 to 1, there
  float zncc_here = 0.0F;                             ///< [] where the shape has the sample
};

struct LineSearchOptions {
  int level = 0;          ///< [] how often the image is halved
  int reach_px = 6;       ///< [] px of the level, 0 to kMostReach
  float min_zncc = 0.6F;  ///< []
};

/// Looks for pieces of the texture near where a shape has them. The patch, of 7 x 7 pixels, is
/// rendered as the camera would see it, by the affine map of its face at the sample. One axis is
/// along the normal n of the edge: the direction in which the grey levels change most. Along n the
/// method searches the image for the largest zero-mean normalised correlation (ZNCC). A pixel
/// farther away must correlate better by 0.01. A parabola through the best pixel and its neighbours
/// gives the fraction of a pixel. An edge has no information across n, so the residual for the
/// point X is n . (pi(X) - seen).
class LineSearch {
 public:
  static constexpr int kSide = 7, kSize = kSide * kSide, kMostReach = 12;

  /// Loads the data that are the same in all frames. The texture pyramid must outlive it.
  void load(const Template& templ, const Pyramid& texture);

  /// `vertices_m` [V,3] m, camera frame.
  Sighting look(const Pyramid& image, const Pinhole& camera, const Points3& vertices_m,
                const Sample& sample, const LineSearchOptions& options);

 private:
  /// The texture around a sample as the image has it.
  struct LocalView {
    Eigen::Vector2f place = Eigen::Vector2f::Zero();          ///< [2] px of the level
    Eigen::Vector2f texel = Eigen::Vector2f::Zero();          ///< [2] px of `texture`
    Eigen::Matrix2f texels_per_px = Eigen::Matrix2f::Zero();  ///< [2,2]
    const Picture* texture = nullptr;
    double scale = 1.0;  ///< from `texture` to the template's
  };
  using Patch = std::array<float, kSize>;

  bool project(const Pinhole& camera, const Points3& vertices_m, const Sample& sample, int level,
               LocalView& view) const;
  bool is_object(const LocalView& view) const;
  Eigen::Vector2f normal_of(const LocalView& view) const;
  bool draw(const LocalView& view, const Eigen::Vector2f& normal);
  void correlate(const Picture& image, const LocalView& view, const Eigen::Vector2f& normal,
                 int reach_px);

  const Pyramid* texture_ = nullptr;
  Faces faces_;
  std::vector<Eigen::Matrix2d> from_flat_;  ///< [F] inverse of the sides in the texture, 1/px
  Array<std::uint8_t> mask_;                ///< a copy
  Patch patch_{};                           ///< pixels of the sample: mean 0, norm 1
  std::array<float, kSide*(kSide + 2 * kMostReach)> strip_{};  ///< pixels of the image, rows along
                                                               ///< n
  std::array<float, 2 * kMostReach + 1> scores_{};  ///< ZNCC by shift; -2 beyond the image
};

}  // namespace weft::collins_integrated
