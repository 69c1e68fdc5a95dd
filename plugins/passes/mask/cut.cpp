// SPDX-License-Identifier: Apache-2.0
#include "cut.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::mask {
namespace {

constexpr int kColours = 5;                 // in a mixture of cv::grabCut
constexpr double kResolution = 6.0;         // grey levels within which colours are alike
constexpr std::uint64_t kState = 20240917;  // start of OpenCV's generator
constexpr int kEdgeReach = 2;               // reduced px from an outline to its edge
constexpr int kWithoutEdge = 4;             // reduced px around an outline without one
constexpr int kGuideReach = 5;              // px
constexpr double kGuideNoise = 6.0;         // grey levels below which the guide has no edge

/// Gives OpenCV's generator a known state, and the former one back.
class KnownState {
 public:
  KnownState() : before_(cv::theRNG().state) { cv::theRNG().state = kState; }
  ~KnownState() { cv::theRNG().state = before_; }
  KnownState(const KnownState&) = delete;
  KnownState& operator=(const KnownState&) = delete;

 private:
  std::uint64_t before_;
};

/// A mixture in the layout of cv::grabCut: shares, means, covariances.
class Mixture {
 public:
  explicit Mixture(const cv::Mat& model) {
    for (int k = 0; k < kColours; ++k) {
      const double share = model.at<double>(k);
      if (!(share > 0.0)) continue;
      Eigen::Matrix3d covariance;
      Colour colour;
      for (int i = 0; i < 3; ++i) {
        colour.mean[i] = model.at<double>(kColours + 3 * k + i);
        for (int j = 0; j < 3; ++j) {
          covariance(i, j) = model.at<double>(4 * kColours + 9 * k + 3 * i + j);
        }
      }
      covariance.diagonal().array() += kResolution * kResolution;
      colour.inverse = covariance.inverse();
      colour.height = share / std::sqrt(covariance.determinant());
      colours_.push_back(colour);
    }
  }

  double density(const Eigen::Vector3d& at) const {
    double sum = 0.0;
    for (const Colour& colour : colours_) {
      const Eigen::Vector3d off = at - colour.mean;
      sum += colour.height * std::exp(-0.5 * off.dot(colour.inverse * off));
    }
    return sum;
  }

 private:
  struct Colour {
    Eigen::Vector3d mean;
    Eigen::Matrix3d inverse;
    double height = 0.0;
  };
  std::vector<Colour> colours_;
};

/// Mean over both classes alike of sqrt(p q) / ((p + q) / 2), which is the integral of sqrt(p q).
double overlap_of(const Mixture& object, const Mixture& background, const cv::Mat& bgr,
                  const cv::Mat& labels) {
  constexpr int kStride = 3;
  std::array<double, 2> sum{}, count{};
  for (int y = 0; y < bgr.rows; y += kStride) {
    for (int x = 0; x < bgr.cols; x += kStride) {
      const cv::Vec3b& pixel = bgr.at<cv::Vec3b>(y, x);
      const Eigen::Vector3d at(pixel[0], pixel[1], pixel[2]);
      const double p = object.density(at), q = background.density(at);
      const std::size_t side = (labels.at<std::uint8_t>(y, x) & 1) != 0 ? 1 : 0;
      count[side] += 1.0;
      if (p + q > 0.0) sum[side] += 2.0 * std::sqrt(p * q) / (p + q);
    }
  }
  return 0.5 * (sum[0] / std::max(count[0], 1.0) + sum[1] / std::max(count[1], 1.0));
}

/// Seeds that are likelier in the other mixture, in groups of four at least.
cv::Mat seeds_alike(const Mixture& object, const Mixture& background, const cv::Mat& bgr,
                    const cv::Mat& seeds) {
  cv::Mat found(seeds.size(), CV_8U, cv::Scalar(0));
  for (int y = 0; y < bgr.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < bgr.cols; ++x) {
      const std::uint8_t seed = seeds.at<std::uint8_t>(y, x);
      if (seed != cv::GC_BGD && seed != cv::GC_FGD) continue;
      const cv::Vec3b& pixel = bgr.at<cv::Vec3b>(y, x);
      const Eigen::Vector3d at(pixel[0], pixel[1], pixel[2]);
      const bool looks_like_object = object.density(at) > background.density(at);
      if (looks_like_object != (seed == cv::GC_FGD)) found.at<std::uint8_t>(y, x) = 255;
    }
  }
  cv::morphologyEx(found, found, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_RECT, {2, 2}));
  return found;
}

}  // namespace

Cut cut_out(const cv::Mat& bgr, const Seeds& seeds, int iterations) {
  const KnownState state;
  cv::Mat labels = seeds.labels.clone(), background, object;
  for (int k = 0; k < iterations; ++k) {
    ask_to_go_on();
    cv::grabCut(bgr, labels, {}, background, object, 1,
                k == 0 ? cv::GC_INIT_WITH_MASK : cv::GC_EVAL);
  }
  Cut cut;
  cut.object = (labels & 1) * 255;  // GC_FGD and GC_PR_FGD are odd
  const Mixture of_object(object), of_background(background);
  cut.overlap = overlap_of(of_object, of_background, bgr, labels);
  cut.alike = seeds_alike(of_object, of_background, bgr, seeds.labels);
  return cut;
}

cv::Mat near_marked(const cv::Mat& marked, double reach) {
  cv::Mat away;
  cv::distanceTransform(255 - marked, away, cv::DIST_L2, 3);
  return away <= reach;
}

cv::Mat smooth_out(int radius, cv::Mat& object) {
  const cv::Mat disc =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
  cv::Mat smooth, rough;
  cv::morphologyEx(object, smooth, cv::MORPH_OPEN, disc);
  cv::morphologyEx(smooth, smooth, cv::MORPH_CLOSE, disc);
  rough = smooth ^ object;
  // Differences of one pixel are due to the grid.
  cv::morphologyEx(rough, rough, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_RECT, {2, 2}));
  cv::dilate(
      rough, rough,
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kWithoutEdge + 1, 2 * kWithoutEdge + 1}));
  object = smooth;
  return rough;
}

cv::Mat without_edge(const cv::Mat& object, const cv::Mat& grey, double least_edge, double& share) {
  cv::Mat along_x, along_y, smooth, slope, near;
  cv::GaussianBlur(grey, smooth, {3, 3}, 0.0);
  cv::Sobel(smooth, along_x, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(smooth, along_y, CV_32F, 0, 1, 3, 0.125);
  cv::magnitude(along_x, along_y, slope);
  const cv::Mat around =
      cv::getStructuringElement(cv::MORPH_RECT, {2 * kEdgeReach + 1, 2 * kEdgeReach + 1});
  cv::dilate(slope, near, around);
  cv::Mat wider, outline, lacking;
  cv::dilate(object, wider, cv::getStructuringElement(cv::MORPH_CROSS, {3, 3}));
  outline = wider - object;
  lacking = outline & (near < least_edge);
  const int whole = cv::countNonZero(outline);
  share = whole > 0 ? 1.0 - static_cast<double>(cv::countNonZero(lacking)) / whole : 0.0;
  // Single pixels without an edge are noise.
  cv::Mat counted;
  cv::boxFilter(lacking, counted, CV_32F, {5, 5}, {-1, -1}, false);
  lacking.setTo(0, counted < 3.0 * 255.0);
  cv::dilate(
      lacking, lacking,
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * kWithoutEdge + 1, 2 * kWithoutEdge + 1}));
  return lacking;
}

cv::Mat certainty(const cv::Mat& object, const cv::Mat& grey_of_full_size) {
  const cv::Size reach(2 * kGuideReach + 1, 2 * kGuideReach + 1);
  const auto mean = [&](const cv::Mat& values) {
    cv::Mat smooth;
    cv::blur(values, smooth, reach);
    return smooth;
  };
  cv::Mat guide, wanted;
  grey_of_full_size.convertTo(guide, CV_32F);
  cv::resize(object, wanted, guide.size(), 0.0, 0.0, cv::INTER_LINEAR);
  wanted.convertTo(wanted, CV_32F);
  ask_to_go_on();
  const cv::Mat of_guide = mean(guide), of_wanted = mean(wanted);
  const cv::Mat variance = mean(guide.mul(guide)) - of_guide.mul(of_guide);
  const cv::Mat joint = mean(guide.mul(wanted)) - of_guide.mul(of_wanted);
  const cv::Mat gain = joint / (variance + kGuideNoise * kGuideNoise);
  const cv::Mat offset = of_wanted - gain.mul(of_guide);
  ask_to_go_on();
  const cv::Mat result = mean(gain).mul(guide) + mean(offset);
  cv::Mat bytes;
  result.convertTo(bytes, CV_8U);
  return bytes;
}

}  // namespace weft::mask
