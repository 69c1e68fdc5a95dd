// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/solution.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <weft/core/index.hpp>

namespace weft::calibration {
namespace {

constexpr int kPose = 6;

/// Views as OpenCV takes them, and what it answers.
struct Fit {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> image;
  cv::Matx33d matrix;
  cv::Mat distortion;
  std::vector<cv::Mat> rotations, translations;
};

Fit to_opencv(const std::vector<View>& views) {
  Fit fit;
  for (const View& view : views) {
    auto& board = fit.board.emplace_back();
    auto& image = fit.image.emplace_back();
    for (Eigen::Index i = 0; i < view.board_m.rows(); ++i) {
      board.emplace_back(static_cast<float>(view.board_m(i, 0)),
                         static_cast<float>(view.board_m(i, 1)), 0.0F);
      image.emplace_back(static_cast<float>(view.image_px(i, 0)),
                         static_cast<float>(view.image_px(i, 1)));
    }
  }
  return fit;
}

int flags_for(int coefficients) {
  switch (coefficients) {
    case 0:
      return cv::CALIB_FIX_K1 | cv::CALIB_FIX_K2 | cv::CALIB_FIX_K3 | cv::CALIB_ZERO_TANGENT_DIST;
    case 4:
      return cv::CALIB_FIX_K3;
    case 8:
      return cv::CALIB_RATIONAL_MODEL;
    default:
      return 0;
  }
}

bool run(Fit& fit, const ImageSize& size, int coefficients) {
  const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-12);
  try {
    cv::calibrateCamera(fit.board, fit.image, {size.width_px, size.height_px}, fit.matrix,
                        fit.distortion, fit.rotations, fit.translations, flags_for(coefficients),
                        until);
  } catch (const cv::Exception&) {  // no homography, or no starting values
    return false;
  }
  return cv::checkRange(fit.matrix) && cv::checkRange(fit.distortion) && fit.matrix(0, 0) > 0.0 &&
         fit.matrix(1, 1) > 0.0;
}

/// The camera's part of the normal equations of all views: each view's pose is eliminated.
class NormalMatrix {
 public:
  explicit NormalMatrix(int unknowns) : matrix_(Eigen::MatrixXd::Zero(unknowns, unknowns)) {}

  /// [2C, 6 + U]: of the pose, then of the camera.
  void add(const Eigen::MatrixXd& jacobian) {
    const auto pose = jacobian.leftCols(kPose);
    const auto camera = jacobian.rightCols(matrix_.cols());
    const Eigen::MatrixXd mixed = pose.transpose() * camera;
    const Eigen::MatrixXd solved = (pose.transpose() * pose).eval().ldlt().solve(mixed);
    matrix_ += camera.transpose() * camera - mixed.transpose() * solved;
  }

  /// Standard deviations by that of one coordinate; NaN where they are not determined.
  Eigen::VectorXd deviation(double deviation_px) const {
    const Eigen::VectorXd scale = matrix_.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd inverse =
        scaled().ldlt().solve(Eigen::MatrixXd::Identity(matrix_.rows(), matrix_.cols()));
    return deviation_px * inverse.diagonal().cwiseSqrt().cwiseProduct(scale);
  }

  double condition() const {
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled(), Eigen::EigenvaluesOnly)
            .eigenvalues();
    return values.maxCoeff() / std::max(values.minCoeff(), 1e-300);
  }

 private:
  Eigen::MatrixXd scaled() const {
    const Eigen::VectorXd scale = matrix_.diagonal().cwiseSqrt().cwiseInverse();
    return scale.asDiagonal() * matrix_ * scale.asDiagonal();
  }

  Eigen::MatrixXd matrix_;
};

}  // namespace

Result<Solution> solve(const std::vector<View>& views, const ImageSize& size, int coefficients) {
  Fit fit = to_opencv(views);
  if (!run(fit, size, coefficients)) {
    return no_result("no camera fits these views");
  }
  Solution solution;
  solution.fx = fit.matrix(0, 0), solution.fy = fit.matrix(1, 1);
  solution.cx = fit.matrix(0, 2), solution.cy = fit.matrix(1, 2);
  for (int i = 0; i < coefficients; ++i) {
    solution.distortion.push_back(fit.distortion.at<double>(i));
  }
  NormalMatrix normal(4 + coefficients);
  double sum_px2 = 0.0;
  Eigen::Index corners = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    std::vector<cv::Point2f> projected;
    cv::Mat jacobian;
    cv::projectPoints(fit.board[i], fit.rotations[i], fit.translations[i], fit.matrix,
                      solution.distortion, projected, jacobian);
    cv::Matx33d turned;
    cv::Rodrigues(fit.rotations[i], turned);
    solution.tilt_rad.push_back(tilt_of({turned(0, 2), turned(1, 2), turned(2, 2)}));
    Eigen::MatrixXd derivatives;
    cv::cv2eigen(jacobian, derivatives);
    normal.add(derivatives.leftCols(kPose + 4 + coefficients));
    const auto count = static_cast<Eigen::Index>(projected.size());
    ViewError error{0.0, Eigen::MatrixX2d(count, 2)};
    for (Eigen::Index c = 0; c < count; ++c) {
      const cv::Point2f off = fit.image[i][to_index(c)] - projected[to_index(c)];
      error.residual_px.row(c) << off.x, off.y;
    }
    const double off_px2 = error.residual_px.squaredNorm();
    error.rms_px = std::sqrt(off_px2 / static_cast<double>(count));
    sum_px2 += off_px2, corners += count;
    solution.errors.push_back(std::move(error));
  }
  const auto unknowns = 4 + coefficients + kPose * static_cast<int>(views.size());
  const double freedom = std::max(1.0, static_cast<double>(2 * corners - unknowns));
  solution.rms_px = std::sqrt(sum_px2 / static_cast<double>(corners));
  solution.deviation = normal.deviation(std::sqrt(sum_px2 / freedom));
  solution.condition = normal.condition();
  return solution;
}

}  // namespace weft::calibration
