// SPDX-License-Identifier: Apache-2.0
#include "pipeline/monitor/camera_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace weft {
namespace {

constexpr double kSure = 4.0, kFocal_share = 0.07, kAspect_share = 0.03, kLens_px = 1.5,
                 kCentre_share = 0.03;

std::string fixed(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::string factor(double log, double std) {
  return fixed(std::exp(log), 2) + " (+- " + fixed(2.0 * std::exp(log) * std, 2) + ")";
}

/// Judges by both explanations, that the surface keeps its lengths and that it may be stretched.
class Judge {
 public:
  Judge(const std::vector<CameraEvidence>& frames, const Camera& camera, double radius)
      : camera_(camera),
        px_per_k1_(std::pow(radius, 3) * camera.fx),
        kept_(joint_deviation(frames)),
        stretched_(joint_beside_strain(frames)),
        stretch_(joint_stretch(frames)) {}

  std::vector<CameraFault> faults() {
    const double aspect = 0.5 * kAspect_share, lens = kLens_px / px_per_k1_;
    const bool proportions = is_significant(kept_, kAspect, aspect);
    const bool focal = is_significant(kept_, kFocal, kFocal_share);
    // If both are significant at once, only the one that no stretch explains counts.
    const bool only_focal = focal && is_significant(stretched_, kFocal, kFocal_share) &&
                            !is_significant(stretched_, kAspect, aspect);
    if (proportions && !only_focal) {
      add("proportions", proportions_claim(), ": measure the template and calibrate the camera",
          {{kAspect, aspect}});
    } else if (focal) {
      add("focal length",
          "the focal length seems to be " + factor(mean(kFocal), kept_.stds()(kFocal)) +
              " times the one given",
          ", " + fixed(camera_.fx, 0) +
              " px, by the perspective of the surface: all distances from the camera are wrong "
              "by that factor; " +
              focal_advice(),
          {{kFocal, kFocal_share}});
    }
    if (is_significant(kept_, kLens, lens)) {
      add("lens", "the lens seems to bend straight lines",
          ", by " + fixed(std::abs(mean(kLens)) * px_per_k1_, 1) +
              " px at the farthest match (k1 = " + fixed(mean(kLens), 2) + " +- " +
              fixed(2.0 * kept_.stds()(kLens), 2) +
              " in addition to the camera file): calibrate its distortion",
          {{kLens, lens}});
    }
    if (is_significant(kept_, kCentreX, kCentre_share) ||
        is_significant(kept_, kCentreY, kCentre_share)) {
      add("principal point",
          "the principal point seems to lie " +
              centre(kCentreX, camera_.fx, "left of", "right of") + " and " +
              centre(kCentreY, camera_.fy, "above", "below") + " the one given",
          ": was the image cropped or scaled after the calibration?",
          {{kCentreX, kCentre_share}, {kCentreY, kCentre_share}});
    }
    return std::move(faults_);
  }

 private:
  struct Limit {
    Part part;
    double least;  ///< deviation that matters
  };

  double mean(Part part) const { return kept_.mean(part); }

  static bool is_significant(const CameraDeviation& found, Part part, double least) {
    return std::abs(found.mean(part)) > std::max(least, kSure * found.stds()(part));
  }

  /// Probability that the deviation is below that limit, by the normal distribution.
  double fine(const Limit& limit) const {
    const double scale = std::sqrt(2.0) * stretched_.stds()(limit.part);
    const double mean = stretched_.mean(limit.part);
    return 0.5 * (std::erf((limit.least - mean) / scale) + std::erf((limit.least + mean) / scale));
  }

  void add(const char* kind, const std::string& claim, const std::string& advice,
           const std::vector<Limit>& limits) {
    CameraFault fault{kind, claim, claim + advice, false, 1.0};
    for (const Limit& limit : limits) {
      fault.is_sure = fault.is_sure || is_significant(stretched_, limit.part, limit.least);
      fault.fine = std::min(fault.fine, fine(limit));
    }
    if (!fault.is_sure) {
      fault.claim = "either " + claim + ", or the surface stretches, by about " +
                    fixed(100.0 * stretch_, 0) + " % more in one direction than across it";
      fault.text = fault.claim + ": calibrate the camera to find out which";
    }
    faults_.push_back(std::move(fault));
  }

  /// Sources that assume a camera take the estimate as a parameter.
  std::string focal_advice() const {
    if (!CameraAssumption::of(camera_)) return "calibrate it";
    const double longer_side_px =
        static_cast<double>(std::max(camera_.width_px, camera_.height_px));
    return "give the source 'focal_by_side: " +
           fixed(std::exp(mean(kFocal)) * camera_.fx / longer_side_px, 3) + "', or calibrate it";
  }

  std::string proportions_claim() const {
    const auto along = [&](double sign) {
      const double variance = kept_.covariance(kFocal, kFocal) +
                              kept_.covariance(kAspect, kAspect) +
                              2.0 * sign * kept_.covariance(kFocal, kAspect);
      return factor(mean(kFocal) + sign * mean(kAspect), std::sqrt(variance));
    };
    return "fx seems to be " + along(-1.0) + " and fy " + along(1.0) + " times those given, " +
           fixed(camera_.fx, 0) + " and " + fixed(camera_.fy, 0) +
           " px, or the template's height beside its width " +
           fixed(std::exp(2.0 * mean(kAspect)), 2) + " times that given";
  }

  std::string centre(Part part, double focal_px, const char* less, const char* more) const {
    const double off_px = focal_px * mean(part);
    return fixed(std::abs(off_px), 0) + " (+- " + fixed(2.0 * focal_px * kept_.stds()(part), 0) +
           ") px " + (off_px < 0.0 ? less : more);
  }

  Camera camera_;
  double px_per_k1_;
  CameraDeviation kept_, stretched_;
  double stretch_;
  std::vector<CameraFault> faults_;
};

}  // namespace

std::vector<CameraFault> camera_faults(const std::vector<CameraEvidence>& frames,
                                       const Camera& camera, double radius) {
  return Judge(frames, camera, radius).faults();
}

}  // namespace weft
