// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <vector>
#include <weft/data/array.hpp>

namespace weft::detectors {

/// Indices of keypoints in the order (y, x, octave, angle, response), which depends on nothing but
/// the keypoints; equal ones stay as they stood.
std::vector<int> canonical_order(const std::vector<cv::KeyPoint>& keypoints);

/// Drops from `order` the keypoints whose nearest pixel is outside the mask [H,W] or 0 there.
void keep_inside(const std::vector<cv::KeyPoint>& keypoints, const Array<std::uint8_t>& mask,
                 std::vector<int>& order);

/// Cuts `order` down to `limit` keypoints spread over the image, in buckets^2 equal cells (fewer if
/// there would be more cells than keypoints). The strongest of each cell come first, then the
/// second strongest, and so on. Within such a round the stronger response wins, then the place in
/// `order`. Cells without keypoints leave their share to the others. The rest keeps its order.
/// `limit` 0 keeps all.
void keep_spread(const std::vector<cv::KeyPoint>& keypoints, cv::Size image, int limit, int buckets,
                 std::vector<int>& order);

/// Which keypoints a detector gives and in which order: all three in turn. `mask` may be null.
std::vector<int> selection(const std::vector<cv::KeyPoint>& keypoints, cv::Size image,
                           const Array<std::uint8_t>* mask, int limit, int buckets);

/// The same with memory that is kept from image to image.
class Selector {
 public:
  /// As selection(); valid until the next call.
  const std::vector<int>& choose(const std::vector<cv::KeyPoint>& keypoints, cv::Size image,
                                 const Array<std::uint8_t>* mask, int limit, int buckets);

  /// As canonical_order(), into `order`.
  static void put_in_order(const std::vector<cv::KeyPoint>& keypoints, std::vector<int>& order);

  /// As keep_spread().
  void spread(const std::vector<cv::KeyPoint>& keypoints, cv::Size image, int limit, int buckets,
              std::vector<int>& order);

 private:
  /// A keypoint seen by the cap.
  struct Ranked {
    float response;
    int place;  ///< in the order
  };
  struct Rounds {
    int all, left;
  };

  void sort_into_cells(const std::vector<cv::KeyPoint>& keypoints, cv::Size image, int buckets,
                       const std::vector<int>& order);
  Rounds rounds_within(int limit);

  std::vector<int> order_;
  std::vector<int> cells_;      ///< cell of each place
  std::vector<int> first_;      ///< in `ranked_`, of each cell and beyond the last
  std::vector<Ranked> ranked_;  ///< cell by cell
  std::vector<int> counts_;     ///< counts of the cells, ascending
  std::vector<Ranked> last_;    ///< the strongest of each cell beyond the rounds of all
  std::vector<char> keep_;      ///< flag of each place
};

}  // namespace weft::detectors
