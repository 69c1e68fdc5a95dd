// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>
#include <weft/data/matrix.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/sdk/source.hpp>

namespace {

constexpr double kWidth_m = 0.297, kHeight_m = 0.178;
constexpr int kColumns = 24, kRows = 14;  ///< size of the grid of matches
constexpr double kFramesASecond = 30.0;
const weft::Camera kCamera{820.0, 820.0, 319.5, 239.5, 640, 480};

/// The point of a surface rolled about an upright axis behind it, as a circular cylinder: m, camera
/// frame, for the template position (x, y) m. Lengths along the surface are kept.
Eigen::Vector3d rolled(double x_m, double y_m, double curvature_per_m, double distance_m) {
  const double arc_m = x_m - 0.5 * kWidth_m, turn_rad = curvature_per_m * arc_m;
  const bool flat = std::abs(turn_rad) < 1e-6;
  const double across_m = flat ? arc_m : std::sin(turn_rad) / curvature_per_m;
  const double behind_m =
      flat ? 0.5 * turn_rad * arc_m : (1.0 - std::cos(turn_rad)) / curvature_per_m;
  return {across_m, y_m - 0.5 * kHeight_m, distance_m + behind_m};
}

/// Matches of a surface that is rolled ever more tightly, with exact truth.
class MyPluginSource final : public weft::Source {
 public:
  static constexpr weft::About kAbout{.produces = "time correspondences ground_truth",
                                      .random = true};

  explicit MyPluginSource(weft::Params& p) {
    p.read("frames", frames_, "", {1, 1000000}, "number of frames");
    p.read("bend_per_m", bend_per_m_, "1/m", {0, 10}, "curvature of the surface in the last frame");
    p.read("distance_m", distance_m_, "m", {0.1, 100},
           "distance from the camera to the centre of the surface");
    p.read("noise_px", noise_px_, "px", {0, 1000},
           "standard deviation, along u and v, of the image points");
  }

  weft::Result<weft::Camera> open(const weft::Call& /*call*/) override { return kCamera; }

  std::int64_t count() const override { return frames_; }

  weft::Result<weft::SourceFrame> read(std::int64_t index, const weft::Call& call) override {
    if (index < 0 || index >= frames_) {
      return weft::Error{weft::Errc::invalid_value, "there is no frame " + std::to_string(index)};
    }
    weft::Rng rng = call.rng();  // random numbers of this frame, in any order of reading
    const auto done = static_cast<double>(index + 1) / static_cast<double>(frames_);
    const std::int64_t count = std::int64_t{kColumns} * kRows;
    weft::Correspondences matches;
    matches.template_px = weft::Array<double>({count, 2}, 0.0);  // the host makes it of the next
    matches.template_xy_m = weft::Array<double>({count, 2});
    matches.image_px = weft::Array<double>({count, 2});
    matches.face = weft::Array<std::int32_t>({count}, -1);  // the host finds it
    matches.barycentrics = weft::Array<double>({count, 3}, 0.0);
    matches.kept = weft::Array<std::uint8_t>({count}, 1);
    matches.score = weft::Array<double>({count}, 1.0);
    weft::GroundTruth truth;
    truth.template_xy_m = weft::Array<double>({count, 2});
    truth.points_m = weft::Array<double>({count, 3});
    truth.match_xy_px = weft::Array<double>({count, 2});
    truth.kind = "formula";
    for (std::int64_t i = 0; i < count; ++i) {
      const double x_m = (static_cast<double>(i % kColumns) + 0.5) * kWidth_m / kColumns;
      const double y_m = (static_cast<double>(i / kColumns) + 0.5) * kHeight_m / kRows;
      const Eigen::Vector3d point_m = rolled(x_m, y_m, done * bend_per_m_, distance_m_);
      const Eigen::Vector2d pixel =
          weft::project({kCamera.fx, kCamera.fy, kCamera.cx, kCamera.cy}, point_m);
      matches.template_xy_m(i, 0) = truth.template_xy_m(i, 0) = x_m;
      matches.template_xy_m(i, 1) = truth.template_xy_m(i, 1) = y_m;
      truth.points_m.matrix<3>().row(i) = point_m.transpose();
      for (int k = 0; k < 2; ++k) {
        truth.match_xy_px(i, k) = pixel[k];
        matches.image_px(i, k) = pixel[k] + noise_px_ * rng.normal();
      }
    }
    weft::SourceFrame frame;
    frame.time = weft::Time{static_cast<double>(index) / kFramesASecond};
    frame.correspondences = std::move(matches);
    frame.ground_truth = std::move(truth);
    return frame;
  }

 private:
  int frames_ = 5;
  double bend_per_m_ = 6.0;
  double distance_m_ = 0.65;
  double noise_px_ = 0.5;
};

}  // namespace

WEFT_PLUGIN(
    MyPluginSource, "sources/my_plugin", "1.0.0",
    "Generates matches of a surface that is rolled ever more tightly, with exact ground truth.")
