// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/generators/random_deformation.hpp>
#include <weft/generators/random_matches.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/rectangular_grid.hpp>
#include <weft/sdk/source.hpp>

#include "common/scene/random_stream.hpp"

namespace weft::match_trials {
namespace {

/// Purposes of random streams: trials of one seed have the same shapes whatever their matches are.
constexpr std::uint64_t kShapes = 1, kMatches = 2;

/// Matches without images. A trial is a random deformation of a surface and correspondences with
/// it, with a given share of outliers (Shetab-Bushehri et al. 2023, Section V).
class MatchTrials final : public Source {
 public:
  static constexpr About kAbout{
      .reference = "paper: Shetab-Bushehri et al. 2023, ROBUSfT, Section V (synthetic matches)",
      .produces = "correspondences ground_truth"};

  explicit MatchTrials(Params& p) {
    p.read("trials", trials_, "", {1, 1e9}, "number of frames, each an independent trial");
    p.read("seed", seed_, "", {0, 9e15}, "seed of the trials, independent of the run's seed");
    p.read("matches", matches_.count, "", {1, 1000000}, "number of matches per trial");
    p.formerly("correct_rate")
        .read("inlier_rate", matches_.correct_rate, "", {0.0, 1.0},
              "share of matches that are not replaced by a random point of the image");
    p.read("noise_px", matches_.noise_px, "px", {0.0, 1000.0},
           "standard deviation, along u and v, of the image points of inliers");
    p.read("columns", columns_, "", {4, 2000},
           "number of vertices along the width, as in the template");
    p.read("rows", rows_, "", {2, 2000}, "number of vertices along the height, as in the template");
    p.read("width_m", width_m_, "m", {1e-6, 1000.0}, "width of the surface");
    p.read("height_m", height_m_, "m", {1e-6, 1000.0}, "height of the surface");
    p.read("texture_width_px", width_px_, "px", {2, 100000}, "width of the template's texture");
    p.read("texture_height_px", height_px_, "px", {2, 100000}, "height of the template's texture");
    p.read("image_width_px", camera_.width_px, "px", {16, 100000}, "width of the image");
    p.read("image_height_px", camera_.height_px, "px", {16, 100000}, "height of the image");
    p.read("focal_px", focal_px_, "px", {1.0, 1e6}, "focal length");
    read_deformation(p);
  }

  Result<Camera> open(const Call&) override {
    camera_.fx = camera_.fy = focal_px_;
    camera_.cx = 0.5 * static_cast<double>(camera_.width_px - 1);
    camera_.cy = 0.5 * static_cast<double>(camera_.height_px - 1);
    auto faces = rectangular_grid_faces(columns_, rows_);
    if (!faces) return faces.error();
    faces_ = *std::move(faces);
    flat_px_ = rectangular_grid_px(columns_, rows_, width_px_, height_px_);
    rest_m_ = Points3::Zero(flat_px_.rows(), 3);
    rest_m_.leftCols<2>() =
        flat_px_ * Eigen::Vector2d(width_m_ / width_px_, height_m_ / height_px_).asDiagonal();
    auto locator = FaceLocator::create(flat_px_, faces_);
    if (!locator) return locator.error();
    locator_ = *std::move(locator);
    auto deformer = SheetDeformer::create(columns_, rows_, rest_m_, deformation_);
    if (!deformer) return deformer.error();
    deformer_ = *std::move(deformer);
    return camera_;
  }

  std::int64_t count() const override { return trials_; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    if (!deformer_) return Error{Errc::invalid_value, "the source is not open: open it first"};
    if (index < 0 || index >= trials_) {
      return Error{Errc::invalid_value, "there is no trial " + std::to_string(index) +
                                            ": the source has " + std::to_string(trials_) +
                                            ", counted from 0"};
    }
    const auto vertices_m = shape(index, call);
    if (!vertices_m) return vertices_m.error();
    const auto on_mesh = [&](const Eigen::Vector2d&, const FaceLocation& location) {
      return Eigen::Vector3d(interpolate(*vertices_m, faces_, location.face, location.weights));
    };
    Rng rng = stream(kMatches, index);
    const RandomMatches drawn =
        draw_random_matches(flat_px_, *locator_, camera_, on_mesh, matches_, rng);
    SourceFrame frame;
    frame.correspondences = drawn.matches;
    frame.ground_truth = truth(*vertices_m, drawn.true_px);
    return frame;
  }

 private:
  void read_deformation(Params& p) {
    RandomDeformationSpec& d = deformation_;
    p.read("distance_m", d.distance_m, "m", {0.01, 1000.0},
           "distance of the flat surface from the camera");
    p.read("turn_x_rad", d.turn_rad.x(), "rad", {0.0, 3.2}, "maximum rotation of a cell about x");
    p.read("turn_y_rad", d.turn_rad.y(), "rad", {0.0, 3.2}, "maximum rotation of a cell about y");
    p.read("turn_z_rad", d.turn_rad.z(), "rad", {0.0, 3.2}, "maximum rotation of a cell about z");
    p.read("approach_m", d.approach_m, "m", {0.0, 1000.0}, "maximum inward displacement of a cell");
    p.read("shift_y_m", d.shift_y_m, "m", {0.0, 1000.0}, "maximum displacement of a cell along y");
    p.read("shift_z_m", d.shift_z_m, "m", {0.0, 1000.0}, "maximum displacement of a cell along z");
    p.read("sweeps", d.sweeps, "", {1, 1000000},
           "number of sweeps of position-based dynamics over the surface");
    p.read("bend_stiffness", d.bend_stiffness, "", {0.0, 1.0},
           "stiffness of distances across edges; that of the edges is 1");
    p.read("max_strain", d.max_strain, "", {0.0, 1.0},
           "maximum strain of an edge; a shape that exceeds it is sampled again");
    p.read("max_draws", d.max_draws, "", {1, 1e9}, "maximum number of shapes sampled per trial");
  }

  Rng stream(std::uint64_t purpose, std::int64_t trial) const {
    return scene::random_stream(static_cast<std::uint64_t>(seed_), purpose,
                                static_cast<std::uint64_t>(trial));
  }

  /// The first shape that is accepted.
  Result<Points3> shape(std::int64_t trial, const Call& call) const {
    Rng rng = stream(kShapes, trial);
    for (int draw = 0; draw < deformation_.max_draws; ++draw) {
      if (call.cancelled()) return Error{Errc::cancelled, "stopped while drawing a shape"};
      RandomDeformation drawn = deformer_->draw(camera_, rng, [&] { return call.cancelled(); });
      if (drawn.accepted) return std::move(drawn.vertices_m);
    }
    return Error{Errc::invalid_value,
                 "none of " + std::to_string(deformation_.max_draws) +
                     " shapes is within max_strain and in the image: let the cells move less, or "
                     "raise max_strain or distance_m"};
  }

  GroundTruth truth(const Points3& vertices_m, const Points2& true_px) const {
    GroundTruth truth;
    truth.kind = "match_trials";
    truth.template_xy_m = make_array<double>(rest_m_.leftCols<2>());
    truth.points_m = make_array<double>(vertices_m);
    truth.faces = make_array<std::int32_t>(faces_);
    truth.match_xy_px = make_array<double>(true_px);
    return truth;
  }

  std::int64_t trials_ = 1000;
  std::int64_t seed_ = 1;
  RandomMatchesSpec matches_;
  int columns_ = 10, rows_ = 6;
  double width_m_ = 0.297, height_m_ = 0.178;
  int width_px_ = 960, height_px_ = 575;
  double focal_px_ = 820.0;
  RandomDeformationSpec deformation_;

  Camera camera_{0.0, 0.0, 0.0, 0.0, 640, 480};
  Faces faces_;
  Points2 flat_px_;  ///< [V,2] px of the texture
  Points3 rest_m_;   ///< [V,3] m, template frame
  std::optional<FaceLocator> locator_;
  std::optional<SheetDeformer> deformer_;
};

}  // namespace
}  // namespace weft::match_trials

using weft::match_trials::MatchTrials;
WEFT_PLUGIN(MatchTrials, "sources/match_trials", "1.0.0",
            "Draws matches on random deformations of a surface, with a given share of outliers.")
