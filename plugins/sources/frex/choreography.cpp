// SPDX-License-Identifier: Apache-2.0
#include "choreography.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/geometry/rigid_alignment.hpp>

#include "common/scene/random_stream.hpp"
#include "folded_cone.hpp"

namespace weft::frex {
namespace {

constexpr std::uint64_t kMotionStream = 1;
constexpr double kRollTurn_rad = 2.6, kBendTurn_rad = 1.5, kWaveSlope_rad = 0.62;
constexpr double kFoldTurn_rad = 2.3, kFoldWidth_m = 0.06;
constexpr double kFolds = 3.0, kFoldsSlope_rad = 0.8;
constexpr double kFoldsApex = 1.5;   // from the middle, over the distance of the corner
constexpr double kFoldsDrift = 0.2;  // drift of a fold in a period of the movement
constexpr double kBulgeShare = 0.3;  // height of a bulge over half the shorter side
constexpr double kPoisson = 0.3;     // contraction of a stretched surface across
constexpr double kGuideCompliance = 1e-4, kHandCompliance = 1e-5;

/// The plane curve of unit speed with a given curvature, through the origin with the tangent (1,0).
class BentCurve {
 public:
  template <class Curvature>
  BentCurve(double reach_m, const Curvature& curvature_per_m) : step_m_(reach_m / kHalf) {
    points_.resize(2 * kHalf + 1, Eigen::Vector2d::Zero());
    for (const int way : {1, -1}) {
      double turn = 0.0;
      for (int k = 0; k < kHalf; ++k) {
        const double middle = way * (k + 0.5) * step_m_;
        const double half_turn = 0.5 * way * step_m_ * curvature_per_m(middle);
        turn += half_turn;
        const Eigen::Vector2d tangent(std::cos(turn), std::sin(turn));
        turn += half_turn;
        points_[at(way * (k + 1))] = points_[at(way * k)] + way * step_m_ * tangent;
      }
    }
  }

  /// The point at s, or as far beside it as `beside_m`; s up to `reach_m` on either side.
  Eigen::Vector2d operator()(double s_m, double beside_m = 0.0) const {
    const double place = std::clamp(s_m / step_m_ + kHalf, 0.0, 2.0 * kHalf);
    const auto i = std::min(to_index(place), points_.size() - 2);
    const double share = place - static_cast<double>(i);
    Eigen::Vector2d on_it = (1.0 - share) * points_[i] + share * points_[i + 1];
    if (beside_m == 0.0) return on_it;
    const Eigen::Vector2d along = (points_[i + 1] - points_[i]) / step_m_;
    return on_it + beside_m * Eigen::Vector2d(-along.y(), along.x());
  }

 private:
  static constexpr int kHalf = 1024;
  static std::size_t at(int k) { return to_index(k + kHalf); }

  double step_m_;
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace

Choreography::Choreography(const MotionSettings& settings, const RestSheet& sheet)
    : Choreography(settings, sheet, scene::random_stream(settings.seed, kMotionStream)) {}

Choreography::Choreography(const MotionSettings& settings, const RestSheet& sheet, Rng rng)
    : settings_(settings),
      sways_(settings, rng),
      in_hand_(sheet.in_hand),
      centred_m_(sheet.rest_m.leftCols<2>()),
      behind_m_(sheet.rest_m.col(2)) {
  // A swollen surface cannot keep its lengths.
  if (settings_.pattern != Pattern::bulge) section_ = CrossSection::of(sheet);
  if (section_) centred_m_ = sheet.flat_m();
  const Eigen::RowVector2d low = centred_m_.colwise().minCoeff();
  const Eigen::RowVector2d high = centred_m_.colwise().maxCoeff();
  centred_m_.rowwise() -= 0.5 * (low + high);
  half_m_ = 0.5 * (high - low).transpose();
  if (section_) {
    // The rest shape itself: its lengths are those of the template to the last digit.
    const Points3 unbent_m = section_->rolled(centred_m_, [](double) { return 0.0; });
    rest_m_ = transform_points(*align_points(sheet.rest_m, unbent_m), sheet.rest_m);
  }
  if (settings_.pattern == Pattern::handles) {
    handles_.emplace(settings_.bend, settings_.seed);
  }
  sign_ = rng.below(2) == 0 ? -1.0 : 1.0;
  ruling_rad_ = rng.uniform(-0.35, 0.35);
  if (settings_.pattern == Pattern::corner_fold) {
    // Towards one of the corners; a corner that folds to the back would hide what it does.
    const double corner = std::atan2(half_m_.y(), half_m_.x()) + rng.uniform(0.0, 0.35);
    ruling_rad_ = std::array{corner, M_PI - corner, corner - M_PI, -corner}[rng.below(4)];
    sign_ = -1.0;
  }
  if (settings_.pattern == Pattern::folds) {
    const double right = rng.below(2) == 0 ? -1.0 : 1.0, below = rng.below(2) == 0 ? -1.0 : 1.0;
    apex_m_ = kFoldsApex * Eigen::Vector2d(right * half_m_.x(), below * half_m_.y());
    folds_rad_ = rng.uniform(0.0, 2.0 * M_PI);
  }
  if (section_) ruling_rad_ = section_->ruling_rad();
}

double Choreography::phase_at(double t_s) const { return sways_.phase_at(t_s); }

double Choreography::share_at(double t_s) const {
  return 0.5 * settings_.bend * (1.0 - std::cos(phase_at(t_s)));
}

/// The size of growing patterns: from 0 to their full size in one period.
double Choreography::grown_at(double t_s) const {
  return settings_.bend * eased(std::min(1.0, t_s / settings_.period_s));
}

/// Strain along x is largest in the middle column and fades to the sides; the map of the plane onto
/// itself keeps the surface developable.
Points2 Choreography::stretched(double t_s) const {
  const double strain = settings_.stretch * 0.5 * (1.0 - std::cos(0.8 * phase_at(t_s)));
  Points2 plane = centred_m_;
  if (strain <= 0.0) return plane;
  for (Eigen::Index v = 0; v < plane.rows(); ++v) {
    const double xi = plane(v, 0) / half_m_.x();
    plane(v, 0) += 0.5 * strain * half_m_.x() * (xi + std::sin(M_PI * xi) / M_PI);
    plane(v, 1) *= 1.0 - kPoisson * strain * 0.5 * (1.0 + std::cos(M_PI * xi));
  }
  return plane;
}

double Choreography::extent_m(double ruling_rad) const {
  return 2.0 * (half_m_.x() * std::abs(std::cos(ruling_rad)) +
                half_m_.y() * std::abs(std::sin(ruling_rad)));
}

double Choreography::curvature_per_m(double s_m, double t_s, const HandlePair::Pose& hands) const {
  const double share = sign_ * share_at(t_s), extent_m = this->extent_m(hands.ruling_rad);
  if (handles_) {  // from that which turns the left border to that which turns the right one
    const double right = eased(std::clamp(s_m / extent_m + 0.5, 0.0, 1.0));
    return 2.0 / extent_m * ((1.0 - right) * hands.turn_rad[0] + right * hands.turn_rad[1]);
  }
  if (settings_.pattern == Pattern::roll) return share * kRollTurn_rad / extent_m;
  if (settings_.pattern == Pattern::s_bend) {
    return share * kBendTurn_rad * M_PI / extent_m * std::sin(2.0 * M_PI * s_m / extent_m);
  }
  if (settings_.pattern == Pattern::wave) {
    const double frequency = 4.0 * M_PI / extent_m;
    const double ramp = settings_.bend * eased(std::min(1.0, 2.0 * t_s / settings_.period_s));
    return sign_ * ramp * kWaveSlope_rad * frequency *
           std::sin(frequency * s_m - 1.5 * phase_at(t_s));
  }
  if (settings_.pattern == Pattern::folds) {  // for a surface that can be bent about one direction
    const double frequency = kFolds * 2.0 * M_PI / extent_m;
    return grown_at(t_s) * kFoldsSlope_rad * frequency *
           std::cos(frequency * s_m + folds_rad_ + kFoldsDrift * phase_at(t_s));
  }
  // A fold half-way from the middle to the corner.
  const double off = (s_m - 0.27 * extent_m) / kFoldWidth_m;
  return share * kFoldTurn_rad / (std::sqrt(M_PI) * 0.5 * kFoldWidth_m) *
         std::exp(-4.0 * off * off);
}

Points3 Choreography::bent(const Points2& flat_m, double t_s) const {
  auto hands = handles_ ? handles_->at(t_s) : HandlePair::Pose{{}, ruling_rad_};
  if (section_) hands.ruling_rad = section_->ruling_rad();
  const auto curvature = [&](double s_m) { return curvature_per_m(s_m, t_s, hands); };
  if (section_) return section_->rolled(flat_m, curvature);
  const Eigen::RowVector2d across(std::cos(hands.ruling_rad), std::sin(hands.ruling_rad));
  const Eigen::RowVector2d ruling(-across.y(), across.x());
  const BentCurve curve(1.3 * half_m_.norm(), curvature);
  Points3 surface(flat_m.rows(), 3);
  for (Eigen::Index v = 0; v < flat_m.rows(); ++v) {
    const Eigen::Vector2d on_curve = curve(flat_m.row(v).dot(across), behind_m_[v]);
    const Eigen::RowVector2d plane = on_curve.x() * across + flat_m.row(v).dot(ruling) * ruling;
    surface.row(v) << plane, on_curve.y();
  }
  return surface;
}

Points3 Choreography::bulged(const Points2& flat_m, double t_s) const {
  const double height_m = kBulgeShare * share_at(t_s) * half_m_.minCoeff();
  Points3 surface(flat_m.rows(), 3);
  for (Eigen::Index v = 0; v < flat_m.rows(); ++v) {
    const double xi = centred_m_(v, 0) / half_m_.x(), eta = centred_m_(v, 1) / half_m_.y();
    const double dome = std::pow((1.0 - xi * xi) * (1.0 - eta * eta), 2);
    surface.row(v) << flat_m.row(v), behind_m_[v] - height_m * dome;
  }
  return surface;
}

/// Folds that run out of a point beyond a corner.
Points3 Choreography::folded(const Points2& flat_m, double t_s) const {
  const double middle_rad = std::atan2(-apex_m_.y(), -apex_m_.x());
  double reach_rad = 0.0;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Eigen::Vector2d corner = Eigen::Vector2d(x, y).cwiseProduct(half_m_) - apex_m_;
      const double beside = std::atan2(corner.y(), corner.x()) - middle_rad;
      reach_rad = std::max(reach_rad, std::abs(std::remainder(beside, 2.0 * M_PI)));
    }
  }
  reach_rad *= 1.0 + settings_.stretch;
  const double frequency = kFolds * M_PI / reach_rad;
  const double begin_rad = folds_rad_ + kFoldsDrift * phase_at(t_s);
  const double slope = grown_at(t_s) * kFoldsSlope_rad;
  const FoldedCone cone(apex_m_, middle_rad, reach_rad, [&](double angle_rad) {
    return slope * frequency * std::cos(frequency * angle_rad + begin_rad);
  });
  Points3 surface(flat_m.rows(), 3);
  for (Eigen::Index v = 0; v < flat_m.rows(); ++v) {
    surface.row(v) = cone.at(flat_m.row(v), behind_m_[v]).transpose();
  }
  return surface;
}

Points3 Choreography::lengths_at(double t_s) const {
  const Points2 plane = stretched(t_s);
  if (settings_.pattern == Pattern::bulge) return bulged(plane, t_s);
  if (section_) {
    const auto at_rest = [](double) { return 0.0; };
    return settings_.stretch > 0.0 ? section_->rolled(plane, at_rest) : rest_m_;
  }
  Points3 surface(plane.rows(), 3);
  surface << plane, behind_m_;
  return surface;
}

Points3 Choreography::surface_at(double t_s) const {
  const Points2 plane = stretched(t_s);
  if (settings_.pattern == Pattern::bulge) return bulged(plane, t_s);
  if (settings_.pattern == Pattern::folds && !section_) return folded(plane, t_s);
  return bent(plane, t_s);
}

std::vector<scene::ClothGuide> Choreography::guides_at(double t_s) const {
  const Points3 surface = surface_at(t_s);
  const Eigen::Isometry3d pose = sways_.pose_at(t_s);
  std::vector<scene::ClothGuide> guides;
  guides.reserve(to_index(surface.rows()));
  for (Eigen::Index v = 0; v < surface.rows(); ++v) {
    const bool in_hand = handles_ && in_hand_[to_index(v)];
    guides.push_back({static_cast<std::int32_t>(v), pose * surface.row(v).transpose(),
                      in_hand ? kHandCompliance : kGuideCompliance});
  }
  return guides;
}

Points3 Choreography::start() const {
  Points3 sheet = lengths_at(0.0);
  sheet.col(2).array() += settings_.distance_m;
  return sheet;
}

}  // namespace weft::frex
