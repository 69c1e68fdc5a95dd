// SPDX-License-Identifier: Apache-2.0
#include "seeds.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

#include "common/unwarping/unwarping.hpp"

namespace weft::mask {
namespace {

constexpr double kFirstLookBand = 3.0;      // times the band
constexpr double kLeastOccluder = 0.003;    // share of the object's pixels
constexpr double kOccluderMargin_px = 8.0;  // in the image
constexpr int kEveryNth = 3;                // pixel in the fit of the gain
constexpr int kFitRounds = 4;
constexpr double kUsualDeviations = 3.0;

/// Labels by the distance from the predicted outline alone.
cv::Mat labels_around(const cv::Mat& inside, const cv::Mat& depth, double band) {
  cv::Mat away;
  cv::distanceTransform(255 - inside, away, cv::DIST_L2, 3);
  cv::Mat labels(inside.size(), CV_8U, cv::Scalar(cv::GC_PR_BGD));
  labels.setTo(cv::GC_BGD, away > band);
  labels.setTo(cv::GC_PR_FGD, depth > 0.0);
  return labels;
}

/// Distance of each pixel inside to the outline.
cv::Mat depth_of(const cv::Mat& inside) {
  cv::Mat depth;
  cv::distanceTransform(inside, depth, cv::DIST_L2, 3);
  return depth;
}

/// The texture as it would look in the crop, without light.
cv::Mat rendered(const Rendering& rendering, const Template& templ) {
  cv::Mat texture = unwarping::grey_levels(templ.texture);
  double mesh_px2 = 0.0;
  for (std::int64_t f = 0; f < templ.faces.rows(); ++f) {
    const auto at = [&](std::int64_t k) -> Eigen::Vector2d {
      return {templ.flat_px(templ.faces(f, k), 0), templ.flat_px(templ.faces(f, k), 1)};
    };
    const Eigen::Vector2d a = at(1) - at(0), b = at(2) - at(0);
    mesh_px2 += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  const double seen_px2 = std::max(cv::countNonZero(rendering.inside), 1);
  const double ratio = std::min(std::sqrt(seen_px2 / std::max(mesh_px2, 1.0)), 1.0);
  cv::Mat small;
  const cv::Size size(std::max(1, static_cast<int>(std::lround(texture.cols * ratio))),
                      std::max(1, static_cast<int>(std::lround(texture.rows * ratio))));
  cv::resize(texture, small, size, 0.0, 0.0, cv::INTER_AREA);
  cv::Mat places;
  rendering.texture_px.convertTo(places, CV_32F);
  const auto rx = static_cast<float>(size.width) / static_cast<float>(texture.cols);
  const auto ry = static_cast<float>(size.height) / static_cast<float>(texture.rows);
  for (int y = 0; y < places.rows; ++y) {
    for (int x = 0; x < places.cols; ++x) {
      cv::Vec2f& at = places.at<cv::Vec2f>(y, x);
      at = {(at[0] + 0.5F) * rx - 0.5F, (at[1] + 0.5F) * ry - 0.5F};
    }
  }
  cv::Mat look;
  cv::remap(small, look, places, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return look;
}

/// image = look * (quadratic in x and y), by iteratively reweighted least squares.
class Gain {
 public:
  Gain(const cv::Mat& look, const cv::Mat& image, const cv::Mat& where) {
    Eigen::VectorXd weights;
    gather(look, image, where);
    weights = Eigen::VectorXd::Ones(values_.size());
    for (int round = 0; round < kFitRounds && values_.size() > 6; ++round) {
      ask_to_go_on();
      const Eigen::MatrixXd weighted = weights.asDiagonal() * rows_;
      terms_ = (rows_.transpose() * weighted).ldlt().solve(weighted.transpose() * values_);
      const Eigen::VectorXd off = (rows_ * terms_ - values_).cwiseAbs();
      std::vector<double> sizes(off.data(), off.data() + off.size());
      usual_ = std::max(1.4826 * median(sizes), 1.0);
      weights = (1.0 + (off / (2.0 * usual_)).array().square()).square().inverse();
    }
    if (!terms_.allFinite()) terms_.setZero();
  }

  double at(int x, int y) const { return row(x, y).dot(terms_); }
  /// Standard deviation of the pixels that follow it.
  double usual() const { return usual_; }

 private:
  using Row = Eigen::Matrix<double, 1, 6>;
  Row row(int x, int y) const {
    const double u = 2.0 * x / size_.width - 1.0, v = 2.0 * y / size_.height - 1.0;
    Row row;
    row << 1.0, u, v, u * u, u * v, v * v;
    return row;
  }
  void gather(const cv::Mat& look, const cv::Mat& image, const cv::Mat& where) {
    size_ = look.size();
    std::vector<double> values, rows;
    for (int y = 0; y < look.rows; y += kEveryNth) {
      for (int x = 0; x < look.cols; x += kEveryNth) {
        if (where.at<std::uint8_t>(y, x) == 0) continue;
        const Row own = row(x, y) * look.at<std::uint8_t>(y, x);
        rows.insert(rows.end(), own.data(), own.data() + 6);
        values.push_back(image.at<std::uint8_t>(y, x));
      }
    }
    const auto count = static_cast<Eigen::Index>(values.size());
    values_ = Eigen::Map<const Eigen::VectorXd>(values.data(), count);
    rows_ = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(rows.data(),
                                                                                        count, 6);
  }

  cv::Size size_;
  Eigen::VectorXd values_;
  Eigen::MatrixXd rows_;
  Eigen::Matrix<double, 6, 1> terms_ = Eigen::Matrix<double, 6, 1>::Zero();
  double usual_ = 1.0;
};

/// The connected parts of `differs` that reach the inside of the object.
cv::Mat occluders(const cv::Mat& differs, const cv::Mat& inner, double least_px2, double scale) {
  cv::Mat opened, numbers, statistics, centres;
  cv::morphologyEx(differs, opened, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  const int count = cv::connectedComponentsWithStats(opened, numbers, statistics, centres, 4);
  std::vector<std::uint8_t> is_occluder(to_index(count), 0);
  for (int y = 0; y < numbers.rows; ++y) {
    for (int x = 0; x < numbers.cols; ++x) {
      const int number = numbers.at<int>(y, x);
      const bool counts = number > 0 && inner.at<std::uint8_t>(y, x) != 0 &&
                          statistics.at<int>(number, cv::CC_STAT_AREA) >= least_px2;
      if (counts) is_occluder[to_index(number)] = 1;
    }
  }
  cv::Mat found(differs.size(), CV_8U, cv::Scalar(0));
  for (int y = 0; y < numbers.rows; ++y) {
    for (int x = 0; x < numbers.cols; ++x) {
      if (is_occluder[to_index(numbers.at<int>(y, x))] != 0) found.at<std::uint8_t>(y, x) = 255;
    }
  }
  const int reach = static_cast<int>(std::ceil(kOccluderMargin_px * scale));
  cv::dilate(found, found,
             cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach + 1, 2 * reach + 1}));
  return found;
}

}  // namespace

Seeds seeds_of_shape(const Rendering& rendering, const Template& templ, const cv::Mat& grey,
                     double scale, const SeedOptions& options) {
  const double band = options.band_px * scale;
  const cv::Mat depth = depth_of(rendering.inside);
  const cv::Mat inner = depth > band;
  Seeds seeds{labels_around(rendering.inside, depth, band), {}, 0.0};
  cv::Mat look, image;
  cv::blur(rendered(rendering, templ), look, {3, 3});
  cv::blur(grey, image, {3, 3});
  const Gain gain(look, image, inner);
  const double most = std::max(options.agreement, kUsualDeviations * gain.usual());
  cv::Mat differs(grey.size(), CV_8U, cv::Scalar(0));
  int agreeing = 0;
  for (int y = 0; y < grey.rows; ++y) {
    ask_to_go_on();
    for (int x = 0; x < grey.cols; ++x) {
      if (rendering.inside.at<std::uint8_t>(y, x) == 0) continue;
      const double expected = gain.at(x, y) * look.at<std::uint8_t>(y, x);
      const bool agrees = std::abs(expected - image.at<std::uint8_t>(y, x)) <= most;
      if (!agrees) differs.at<std::uint8_t>(y, x) = 255;
      if (!agrees || inner.at<std::uint8_t>(y, x) == 0) continue;
      ++agreeing;
      seeds.labels.at<std::uint8_t>(y, x) = cv::GC_FGD;
    }
  }
  seeds.agreement = agreeing / std::max(1.0, static_cast<double>(cv::countNonZero(inner)));
  const double object_px2 = cv::countNonZero(rendering.inside);
  seeds.occluded = occluders(differs, inner, kLeastOccluder * object_px2, scale);
  return seeds;
}

Seeds seeds_of_matches(const Rendering& rendering, const Correspondences& matches, const Crop& crop,
                       const SeedOptions& options) {
  const double band = kFirstLookBand * options.band_px * crop.scale;
  Seeds seeds{labels_around(rendering.inside, depth_of(rendering.inside), band),
              cv::Mat(rendering.inside.size(), CV_8U, cv::Scalar(0)), 1.0};
  std::vector<cv::Point> kept, hull;
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    if (matches.kept(i) == 0) continue;
    kept.emplace_back(crop.inside(matches.image_px(i, 0), matches.image_px(i, 1)));
  }
  cv::convexHull(kept, hull);
  cv::fillConvexPoly(seeds.labels, hull, cv::Scalar(cv::GC_FGD));
  return seeds;
}

}  // namespace weft::mask
