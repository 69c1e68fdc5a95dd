// SPDX-License-Identifier: Apache-2.0
#include "local_map.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <weft/core/statistics.hpp>

#include "robust_weight.hpp"

namespace weft::famouri_local {
namespace {

constexpr std::size_t kFewestSamples = 4;
constexpr double kNarrowest = 0.05;  // ratio of second moments, across over along
constexpr int kMapRounds = 4;
constexpr double kLeastScale = 0.2;  // share of the expected noise, where that is a guess
constexpr double kAffine = 1e6;      // noise over second derivatives, where these are to be 0

}  // namespace

std::optional<LocalMap> LocalMapFit::fit(std::span<const MapSample> samples, std::size_t own,
                                         const MapExpectation& expected) {
  h_m_ = usual_distance_m(samples);
  if (!(h_m_ > 0.0)) return std::nullopt;
  prepare(samples, expected);
  for (int round = 0; round < kMapRounds; ++round) {
    if (round > 0) weigh(expected);
    if (!solve(samples)) return std::nullopt;
    measure(samples);
  }
  return read(own, expected.noise);
}

/// The median distance of the samples; 0 where they do not spread in two directions.
double LocalMapFit::usual_distance_m(std::span<const MapSample> samples) {
  if (samples.size() < kFewestSamples) return 0.0;
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  for (const MapSample& sample : samples) middle_m += sample.offset_m;
  middle_m /= static_cast<double>(samples.size());
  Eigen::Matrix2d spread_m2 = Eigen::Matrix2d::Zero();
  scratch_.clear();
  for (const MapSample& sample : samples) {
    const Eigen::Vector2d offset_m = sample.offset_m - middle_m;
    spread_m2 += offset_m * offset_m.transpose();
    scratch_.push_back(sample.offset_m.norm());
  }
  const double half = 0.5 * spread_m2.trace();
  const double half_gap = std::hypot(0.5 * (spread_m2(0, 0) - spread_m2(1, 1)), spread_m2(0, 1));
  const bool is_wide = half - half_gap > kNarrowest * (half + half_gap);
  return is_wide ? median_in_place(scratch_) : 0.0;
}

void LocalMapFit::prepare(std::span<const MapSample> samples, const MapExpectation& expected) {
  const double second = expected.second_per_m2 * h_m_ * h_m_;
  const double ratio = second > 0.0 ? expected.noise / second : kAffine;
  prior_.setZero();
  prior_.tail<3>().setConstant(ratio * ratio);
  terms_.clear(), nearness_.clear();
  for (const MapSample& sample : samples) {
    const Eigen::Vector2d d = sample.offset_m / h_m_;
    Vector6 terms;
    terms << 1.0, d.x(), d.y(), 0.5 * d.x() * d.x(), d.x() * d.y(), 0.5 * d.y() * d.y();
    terms_.push_back(terms);
    nearness_.push_back(std::exp(-0.5 * d.squaredNorm()));
  }
  robust_.assign(samples.size(), 1.0);
}

/// False where the samples do not determine the map.
bool LocalMapFit::solve(std::span<const MapSample> samples) {
  Matrix6 normal = prior_.asDiagonal();
  Eigen::Matrix<double, 6, 2> moments = Eigen::Matrix<double, 6, 2>::Zero();
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const Vector6 weighted = nearness_[j] * robust_[j] * terms_[j];
    normal.noalias() += weighted * terms_[j].transpose();
    moments.noalias() += weighted * samples[j].eta.transpose();
  }
  const Eigen::LLT<Matrix6> factor(normal);
  if (factor.info() != Eigen::Success) return false;
  inverse_ = factor.solve(Matrix6::Identity());
  coefficients_ = factor.solve(moments);
  return coefficients_.allFinite() && inverse_.allFinite();
}

void LocalMapFit::measure(std::span<const MapSample> samples) {
  off_.clear();
  for (std::size_t j = 0; j < samples.size(); ++j) {
    off_.push_back((samples[j].eta - coefficients_.transpose() * terms_[j]).norm());
  }
}

/// Weighs each sample by how far off it is.
void LocalMapFit::weigh(const MapExpectation& expected) {
  scratch_ = off_;
  const double own_scale = median_in_place(scratch_) / kMedianLength;
  const double scale =
      std::max(own_scale, expected.is_noise_known ? expected.noise : kLeastScale * expected.noise);
  for (std::size_t j = 0; j < off_.size(); ++j) robust_[j] = robust_weight(off_[j] / scale);
}

LocalMap LocalMapFit::read(std::size_t own, double noise) const {
  Matrix6 once = Matrix6::Zero(), twice = Matrix6::Zero();
  double sum = 0.0, squares = 0.0;
  for (std::size_t j = 0; j < terms_.size(); ++j) {
    const double weight = nearness_[j] * robust_[j];
    const Matrix6 outer = weight * terms_[j] * terms_[j].transpose();
    once += outer;
    twice += weight * outer;
    sum += weight;
    squares += weight * off_[j] * off_[j];
  }
  LocalMap map;
  map.eta = coefficients_.row(0);
  map.jacobian_per_m = coefficients_.middleRows<2>(1).transpose() / h_m_;
  // The noise of the samples, and of the second derivatives what the prior lets them be.
  const Matrix6 prior = prior_.asDiagonal();
  const Matrix6 covariance = noise * noise * inverse_ * (twice + prior) * inverse_;
  map.covariance_per_m2 = covariance.block<2, 2>(1, 1) / (h_m_ * h_m_);
  // The expectation of the weighted squares is 2 noise^2 times this.
  const Matrix6 hat = inverse_ * twice;
  const double freedom = sum - 2.0 * hat.trace() + (hat * inverse_ * once).trace();
  map.noise2 = squares / (2.0 * std::max(freedom, 1e-3));
  const double leverage = nearness_[own] * robust_[own] * inverse_(0, 0);
  map.own_off = off_[own] / std::sqrt(std::max(1.0 - leverage, 1e-3));
  return map;
}

}  // namespace weft::famouri_local
