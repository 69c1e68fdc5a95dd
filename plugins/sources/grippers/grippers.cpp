// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/sdk/source.hpp>

#include "common/scene/random_stream.hpp"

namespace weft::grippers {
namespace {

/// Purposes of random streams.
constexpr std::uint64_t kOffset = 1, kNoise = 2;

/// The places of the grippers, as shares of the surface's width and height, in the order of their
/// use. Two face each other, four are all sides, and eight have the corners too.
constexpr std::array<std::array<double, 2>, 8> kPlaces{{{0.0, 0.5},
                                                        {1.0, 0.5},
                                                        {0.5, 0.0},
                                                        {0.5, 1.0},
                                                        {0.0, 0.0},
                                                        {1.0, 1.0},
                                                        {1.0, 0.0},
                                                        {0.0, 1.0}}};

/// A unit vector of any direction alike.
Eigen::Vector3d random_direction(Rng& rng) {
  Eigen::Vector3d direction;
  for (Eigen::Index k = 0; k < 3; ++k) direction[k] = rng.normal();
  return direction.normalized();
}

/// Makes known points of the truth of another source, as a robot with an error of calibration
/// would.
class Grippers final : public Source {
 public:
  static constexpr About kAbout{
      .reference = "own: Shetab-Bushehri et al. 2023, ROBUSfT (grippers of a robot)",
      .produces = "image time known_points ground_truth region",
      .uses_truth = true};

  explicit Grippers(Params& p) {
    p.component("frames", frames_, "source of the frames and of their ground truth");
    p.read(
        "count", count_, "", {0, static_cast<double>(kPlaces.size())},
        "number of grippers: middles of the left, right, upper and lower border, then the corners");
    p.read("offset_mm", offset_mm_, "mm", {0.0, 1000.0},
           "length of the calibration error: one displacement of all points in all frames");
    p.read("noise_mm", noise_mm_, "mm", {0.0, 1000.0},
           "standard deviation of the error of each coordinate, point and frame");
    p.read("radius_mm", radius_mm_, "mm", {-1.0, 1000.0},
           "reported radius of the points; below 0: the solver's own");
    p.read("seed", seed_, "", {0, 9e15},
           "seed of the offset's direction and of the noise, independent of the run's seed");
  }

  Result<Camera> open(const Call& call) override {
    auto camera = frames_.open(call);
    if (!camera) return camera.error();
    const auto count = frames_.count(call);
    if (!count) return count.error();
    frame_count_ = *count;
    Rng rng = stream(kOffset, 0);
    offset_m_ = kMetresPerMillimetre * offset_mm_ * random_direction(rng);
    return camera;
  }

  std::int64_t count() const override { return frame_count_.frames; }
  bool live() const override { return frame_count_.live != 0; }

  Result<SourceFrame> read(std::int64_t index, const Call& call) override {
    auto given = frames_.read(call);
    if (!given) return given.error();
    const std::string reason = given.degenerate_reason();
    SourceFrame frame = *std::move(given);
    frame.known_points.reset();
    if (frame.ground_truth && frame.ground_truth->count() > 0 && count_ > 0) {
      Rng noise = stream(kNoise, static_cast<std::uint64_t>(index));
      frame.known_points = hold(*frame.ground_truth, noise);
    }
    if (!reason.empty()) return degenerate(std::move(frame), reason);
    return frame;
  }

 private:
  static constexpr double kMetresPerMillimetre = 1e-3;

  Rng stream(std::uint64_t purpose, std::uint64_t frame) const {
    return scene::random_stream(static_cast<std::uint64_t>(seed_), purpose, frame);
  }

  /// The true point nearest to each place, on the template.
  KnownPoints hold(const GroundTruth& truth, Rng& noise) const {
    const auto flat_m = truth.template_xy_m.matrix<2>();
    const Eigen::RowVector2d low = flat_m.colwise().minCoeff();
    const Eigen::RowVector2d size = flat_m.colwise().maxCoeff() - low;
    KnownPoints known{Array<std::int32_t>({count_}), Array<double>({count_, 3}),
                      Array<double>({count_}), Array<double>({count_, 2})};
    for (std::int64_t p = 0; p < count_; ++p) {
      const auto& [x, y] = kPlaces[to_index(p)];
      const Eigen::RowVector2d place = low + Eigen::RowVector2d(x * size.x(), y * size.y());
      Eigen::Index nearest = 0;
      (flat_m.rowwise() - place).rowwise().squaredNorm().minCoeff(&nearest);
      Eigen::Vector3d point_m = truth.points_m.matrix<3>().row(nearest).transpose() + offset_m_;
      for (Eigen::Index k = 0; k < 3; ++k) {
        point_m[k] += kMetresPerMillimetre * noise_mm_ * noise.normal();
      }
      known.vertex(p) = -1;
      known.template_xy_m.matrix<2>().row(p) = flat_m.row(nearest);
      known.points_m.matrix<3>().row(p) = point_m.transpose();
      known.radius_m(p) = kMetresPerMillimetre * radius_mm_;
    }
    return known;
  }

  SourceComponent frames_{"sources/frex"};
  std::int64_t count_ = 2;
  double offset_mm_ = 0.0;
  double noise_mm_ = 0.0;
  double radius_mm_ = -1.0;
  std::int64_t seed_ = 1;

  Count frame_count_;
  Eigen::Vector3d offset_m_ = Eigen::Vector3d::Zero();
};

}  // namespace
}  // namespace weft::grippers

using weft::grippers::Grippers;
WEFT_PLUGIN(Grippers, "sources/grippers", "1.0.0",
            "Derives known points from the ground truth of another source; for experiments only.")
