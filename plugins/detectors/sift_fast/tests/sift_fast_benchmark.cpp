// SPDX-License-Identifier: Apache-2.0
// Times of detectors/sift_fast beside cv::SIFT on the same image. Both run alternately, so that
// other load on the machine affects both, and only the ratios count. All in one thread.
// sift_fast_benchmark [image [rounds]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "common/selection.hpp"
#include "search.hpp"

namespace weft::sift_fast {
namespace {

constexpr std::size_t kKept = 1500;

/// CPU time of this thread.
double processor_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Times of one thing, ms of the processor: waiting for it does not count.
class Times {
 public:
  explicit Times(std::string name) : name_(std::move(name)) {}

  template <class Work>
  void measure(const Work& work) {
    const double start_ms = processor_ms();
    work();
    ms_.push_back(processor_ms() - start_ms);
  }

  double least() const { return *std::min_element(ms_.begin(), ms_.end()); }
  double median() const {
    std::vector<double> sorted = ms_;
    std::nth_element(sorted.begin(), sorted.begin() + to_index(sorted.size() / 2), sorted.end());
    return sorted[sorted.size() / 2];
  }
  void print(const Times& reference) const {
    std::printf("%-32s %8.2f %8.2f   %6.3f %6.3f\n", name_.c_str(), least(), median(),
                least() / reference.least(), median() / reference.median());
  }

 private:
  std::string name_;
  std::vector<double> ms_;
};

/// Blobs of several sizes.
cv::Mat texture() {
  Rng rng(1);
  cv::Mat grey(480, 640, CV_32F, cv::Scalar(128.0));
  for (const double sigma_px : {1.0, 2.0, 4.0, 8.0}) {
    cv::Mat noise(480, 640, CV_32F);
    for (int y = 0; y < noise.rows; ++y) {
      for (int x = 0; x < noise.cols; ++x) noise.at<float>(y, x) = static_cast<float>(rng.normal());
    }
    cv::GaussianBlur(noise, noise, {}, sigma_px);
    grey += 50.0 * sigma_px * noise;
  }
  grey.convertTo(grey, CV_8U);
  return grey;
}

/// The steps of one image.
class Run {
 public:
  Run(const std::string& name, bool upsample, const cv::Rect& part)
      : part_(part),
        search_(settings(upsample)),
        total_(name),
        find_("  layers, extrema, refinement"),
        choose_("  choice of " + std::to_string(kKept)),
        orient_("  orientations"),
        describe_("  descriptors") {}

  void once(const cv::Mat& grey) {
    total_.measure([&] { steps(grey); });
  }
  void print(const Times& reference) const {
    for (const Times* times : {&total_, &find_, &choose_, &orient_, &describe_}) {
      times->print(reference);
    }
    std::printf("  %d extrema, %d keypoints\n", static_cast<int>(extrema_),
                static_cast<int>(kept_));
  }

 private:
  static Settings settings(bool upsample) {
    Settings settings;
    settings.upsample = upsample;
    return settings;
  }

  void steps(const cv::Mat& grey) {
    std::span<const Spot> found;
    const GreyImage image{grey.ptr(part_.y) + part_.x, static_cast<std::ptrdiff_t>(grey.step[0]),
                          part_.width, part_.height};
    find_.measure([&] { found = search_.find(image, 1); });
    extrema_ = found.size();
    choose_.measure([&] { choose(found); });
    orient_.measure([&] { found = search_.orient(chosen_, 1); });
    kept_ = found.size();
    describe_.measure([&] {
      descriptors_.resize(to_index(kDescriptorLength) * found.size());
      search_.describe(found, descriptors_.data(), 1);
    });
  }

  void choose(std::span<const Spot> found) {
    places_.clear();
    for (const Spot& spot : found) {
      const float pitch = static_cast<float>(1 << spot.octave);
      places_.push_back({spot.x * pitch, spot.y * pitch, spot.scale, 0.0F, spot.response});
    }
    chosen_.clear();
    const cv::Size size(2 * part_.width, 2 * part_.height);
    for (const int i : selector_.choose(places_, size, nullptr, kKept, 16)) {
      chosen_.push_back(found[to_index(i)]);
    }
  }

  cv::Rect part_;
  Search search_;
  detectors::Selector selector_;
  std::vector<cv::KeyPoint> places_;
  std::vector<Spot> chosen_;
  std::vector<float> descriptors_;
  std::size_t extrema_ = 0, kept_ = 0;
  Times total_, find_, choose_, orient_, describe_;
};

void run(const cv::Mat& grey, int rounds) {
  const auto opencv = cv::SIFT::create();
  Times detect("cv::SIFT, keypoints"), both("cv::SIFT, and descriptors");
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  const cv::Rect whole(0, 0, grey.cols, grey.rows);
  const double side = std::sqrt(0.38);
  const cv::Rect part(0, 0, static_cast<int>(side * grey.cols) + 32,
                      static_cast<int>(side * grey.rows) + 32);
  Run enlarged("enlarged", true, whole), region("region of 38 %, enlarged", true, part & whole),
      plain("not enlarged", false, whole);
  for (int i = 0; i < rounds; ++i) {
    detect.measure([&] { opencv->detect(grey, keypoints); });
    enlarged.once(grey);
    both.measure([&] { opencv->detectAndCompute(grey, cv::noArray(), keypoints, descriptors); });
    region.once(grey);
    plain.once(grey);
  }
  std::printf("%d x %d, one thread           least   median ms   of cv::SIFT\n", grey.cols,
              grey.rows);
  both.print(both);
  detect.print(both);
  std::printf("  %d keypoints\n", static_cast<int>(keypoints.size()));
  for (const Run* each : {&enlarged, &region, &plain}) each->print(both);
}

}  // namespace
}  // namespace weft::sift_fast

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const cv::Mat grey =
      argc > 1 ? cv::imread(argv[1], cv::IMREAD_GRAYSCALE) : weft::sift_fast::texture();
  if (grey.empty()) {
    std::fprintf(stderr, "cannot read %s\n", argv[1]);
    return 1;
  }
  weft::sift_fast::run(grey, argc > 2 ? std::atoi(argv[2]) : 20);
}
