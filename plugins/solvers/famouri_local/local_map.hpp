// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace weft::famouri_local {

/// A neighbour, as the map around a match sees it.
struct MapSample {
  Eigen::Vector2d offset_m;  ///< [2] m, from the match in the tangent plane at rest
  Eigen::Vector2d eta;       ///< [2] normalised image point
};

/// The expected values of a map before the fit.
struct MapExpectation {
  double noise = 0.0;           ///< [] of a normalised image coordinate: standard deviation
  double second_per_m2 = 0.0;   ///< [] 1/m^2, of a second derivative of eta: standard deviation
  bool is_noise_known = false;  ///< [] false: these samples alone determine the scale of outliers
};

/// How the image point of a place near a match depends on the place.
struct LocalMap {
  Eigen::Vector2d eta;                ///< [2] normalised image point of the match
  Eigen::Matrix2d jacobian_per_m;     ///< [2,2] 1/m, of eta by the tangent plane at rest
  Eigen::Matrix2d covariance_per_m2;  ///< [2,2] 1/m^2, of each row of the Jacobian
  double noise2 = 0.0;   ///< [] squared noise of a normalised image coordinate, estimated from the
                         ///< samples
  double own_off = 0.0;  ///< [] of the match from its own map, over the root of the share of its
                         ///< noise that this would show
};

/// Fits samples (d_j, eta_j) around a match by weighted least squares to
///     eta(d) = eta + J d + (d^T H_x d, d^T H_y d) / 2,
/// with the weights exp(-|d_j|^2 / (2 h^2)), h the median of |d_j|. Three more rounds add the
/// weights of Geman and McClure for samples with large residuals. The second derivatives have a
/// Gaussian prior around 0. With noise the map tends to an affine one, whose Jacobian is more
/// certain but biased where the surface bends. The covariance is that of J under both noise and
/// prior.
class LocalMapFit {
 public:
  /// Nothing for fewer than 4 samples, or where they are about on a line. Then their second moments
  /// in one direction are below a twentieth of those in the other. The match itself is the sample
  /// `own`.
  std::optional<LocalMap> fit(std::span<const MapSample> samples, std::size_t own,
                              const MapExpectation& expected);

 private:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  double usual_distance_m(std::span<const MapSample> samples);
  void prepare(std::span<const MapSample> samples, const MapExpectation& expected);
  bool solve(std::span<const MapSample> samples);
  void measure(std::span<const MapSample> samples);
  void weigh(const MapExpectation& expected);
  LocalMap read(std::size_t own, double noise) const;

  double h_m_ = 1.0;
  std::vector<Vector6> terms_;             ///< [n] of the map at a sample, in units of h
  std::vector<double> nearness_, robust_;  ///< [n] weights
  std::vector<double> off_;                ///< [n] of a sample from the map
  std::vector<double> scratch_;
  Vector6 prior_;    ///< [6] its share of the normal equations
  Matrix6 inverse_;  ///< [6,6] of the normal equations
  Eigen::Matrix<double, 6, 2> coefficients_;
};

}  // namespace weft::famouri_local
