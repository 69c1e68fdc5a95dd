// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/matcher.hpp>

namespace {

using Descriptors = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using DescriptorsView = Eigen::Map<const Descriptors, 0, Eigen::OuterStride<>>;

DescriptorsView view_of(const weft::Array<float>& descriptors) {
  return {descriptors.data(), descriptors.rows(), descriptors.dim(1),
          Eigen::OuterStride<>(descriptors.row_stride())};
}

/// The nearest keypoint of the other side; the lower index wins a tie.
struct Nearest {
  std::int64_t keypoint = -1;
  float distance2 = std::numeric_limits<float>::infinity();
  float second_distance2 = std::numeric_limits<float>::infinity();

  void see(std::int64_t other, float other_distance2) {
    if (other_distance2 < distance2) {
      second_distance2 = distance2;
      distance2 = other_distance2;
      keypoint = other;
    } else if (other_distance2 < second_distance2) {
      second_distance2 = other_distance2;
    }
  }
};

/// A match of two keypoints, by their numbers.
struct Pair {
  std::int64_t of_template, of_image;
  double distance, ratio;
};

/// Two keypoints match if each has the nearest descriptor to the other, and clearly so.
class MyPluginMatcher final : public weft::Matcher {
 public:
  static constexpr weft::About kAbout{
      .reference =
          "paper: Lowe, Distinctive image features from scale-invariant keypoints, IJCV 2004",
      .needs = "keypoints template_keypoints"};

  explicit MyPluginMatcher(weft::Params& p) {
    p.read("ratio", ratio_, "", {0.01, 1},
           "maximum ratio of the nearest to the second nearest descriptor distance");
  }

  weft::Result<weft::Correspondences> match(const weft::MatcherInput& in) override {
    if (!in.keypoints || !in.template_keypoints) {
      return weft::Error{weft::Errc::invalid_data, "needs 'keypoints' and 'template_keypoints'"};
    }
    const weft::Keypoints& image = *in.keypoints;
    const weft::Keypoints& templ = *in.template_keypoints;
    if (image.count() < 2 || templ.count() == 0) {
      return weft::no_result(std::to_string(templ.count()) + " keypoints on the template and " +
                             std::to_string(image.count()) + " in the image are too few");
    }
    if (image.descriptors.rows() != image.count() || templ.descriptors.rows() != templ.count()) {
      return weft::Error{weft::Errc::unsupported,
                         "the descriptors have not the metric l2; use matchers/descriptor"};
    }
    if (image.descriptors.dim(1) != templ.descriptors.dim(1)) {
      return weft::Error{weft::Errc::invalid_data,
                         "the descriptors have two lengths; use one detector for both"};
    }
    const std::vector<Pair> pairs =
        mutual_pairs(view_of(templ.descriptors), view_of(image.descriptors));
    if (pairs.empty()) return weft::no_result("no descriptor is clearly the nearest of another");
    return make_matches(templ, image, pairs);
  }

 private:
  std::vector<Pair> mutual_pairs(const DescriptorsView& templ, const DescriptorsView& image) const {
    std::vector<Nearest> of_template(weft::to_index(templ.rows()));
    std::vector<Nearest> of_image(weft::to_index(image.rows()));
    for (Eigen::Index i = 0; i < templ.rows(); ++i) {
      weft::worked(image.size() / 16);
      const Eigen::VectorXf distance2 = (image.rowwise() - templ.row(i)).rowwise().squaredNorm();
      for (Eigen::Index j = 0; j < image.rows(); ++j) {
        of_template[weft::to_index(i)].see(j, distance2[j]);
        of_image[weft::to_index(j)].see(i, distance2[j]);
      }
    }
    std::vector<Pair> pairs;
    for (Eigen::Index i = 0; i < templ.rows(); ++i) {
      const Nearest& found = of_template[weft::to_index(i)];
      if (found.keypoint < 0 || of_image[weft::to_index(found.keypoint)].keypoint != i) continue;
      const double distance = std::sqrt(static_cast<double>(found.distance2));
      const double second = std::sqrt(static_cast<double>(found.second_distance2));
      if (distance < ratio_ * second) {
        pairs.push_back({i, found.keypoint, distance, distance / second});
      }
    }
    return pairs;
  }

  static weft::Correspondences make_matches(const weft::Keypoints& templ,
                                            const weft::Keypoints& image,
                                            const std::vector<Pair>& pairs) {
    const std::int64_t count = std::ssize(pairs);
    weft::Correspondences matches;
    matches.template_px = weft::Array<double>({count, 2});
    matches.image_px = weft::Array<double>({count, 2});
    matches.template_keypoint = weft::Array<std::int32_t>({count});
    matches.image_keypoint = weft::Array<std::int32_t>({count});
    matches.face = weft::Array<std::int32_t>({count}, -1);  // the host finds it
    matches.barycentrics = weft::Array<double>({count, 3}, 0.0);
    matches.distance = weft::Array<double>({count});
    matches.ratio = weft::Array<double>({count});
    matches.kept = weft::Array<std::uint8_t>({count}, 1);
    matches.score = weft::Array<double>({count}, 1.0);
    std::int64_t m = 0;
    for (const Pair& pair : pairs) {
      for (int k = 0; k < 2; ++k) {
        matches.template_px(m, k) = templ.xy_px(pair.of_template, k);
        matches.image_px(m, k) = image.xy_px(pair.of_image, k);
      }
      matches.template_keypoint(m) = static_cast<std::int32_t>(pair.of_template);
      matches.image_keypoint(m) = static_cast<std::int32_t>(pair.of_image);
      matches.distance(m) = pair.distance;
      matches.ratio(m) = pair.ratio;
      ++m;
    }
    return matches;
  }

  double ratio_ = 0.8;
};

}  // namespace

WEFT_PLUGIN(MyPluginMatcher, "matchers/my_plugin", "1.0.0",
            "Matches mutually nearest keypoints with Lowe's ratio test.")
