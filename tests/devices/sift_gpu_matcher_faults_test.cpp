// SPDX-License-Identifier: Apache-2.0
#include "sift_gpu_faults.hpp"

namespace weft::sift_gpu {
namespace {

using ::testing::HasSubstr;
using testing::input;

/// The same scene again, as another camera would have it.
Image noisy() {
  Image image = plain();
  for (std::int64_t i = 0; i < image.pixels.size(); ++i) {
    std::uint8_t& grey = image.pixels.data()[i];
    grey = static_cast<std::uint8_t>(std::min<int>(255, grey + static_cast<int>(i * 7 % 5)));
  }
  return image;
}

bool same_matches(const PluginAnswer& a, const PluginAnswer& b) {
  const auto one = a.get<Correspondences>(), other = b.get<Correspondences>();
  if (a.status != WEFT_OK || b.status != WEFT_OK || !one || !other) return false;
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::equal(x.data(), x.data() + x.size(), y.data());
  };
  return one->count() > 0 && equal(one->template_keypoint, other->template_keypoint) &&
         equal(one->image_keypoint, other->image_keypoint) &&
         equal(one->distance, other->distance) && equal(one->ratio, other->ratio);
}

class MatcherFaults : public FaultsTest {
 protected:
  void detect_both() {
    detector_.forget();
    templ_ = sift_gpu::detect(detector_, plain());
    image_ = sift_gpu::detect(detector_, noisy());
  }
  PluginAnswer match() {
    matcher_->forget();
    return sift_gpu::match(*matcher_, templ_, image_);
  }
  /// A frame for which the template is on its device already.
  Frame warm() {
    return {[&] {
              detect_both();
              match();
              image_ = sift_gpu::detect(detector_, noisy());
            },
            [&] { return match(); }, [&] { EXPECT_TRUE(same_matches(match(), expected_)); }};
  }
  Frame first() {
    Frame frame = warm();
    frame.get_ready = [&] {
      detect_both();
      matcher_.emplace("matchers/gpu", kParams);
    };
    return frame;
  }

  /// A frame whose descriptors are not on the device.
  Frame of_the_host() {
    const auto run = [this] {
      matcher_->forget();
      return matcher_->process(
          0, {input("keypoints", *image_here_), input("template_keypoints", *templ_here_)});
    };
    return {run, run, [this, run] { EXPECT_TRUE(same_matches(run(), expected_)); }};
  }

  static constexpr const char* kParams = "{mutual: true}";
  PluginUnderTest detector_{"detectors/sift_gpu"}, clean_{"matchers/gpu", kParams};
  std::optional<PluginUnderTest> matcher_{std::in_place, "matchers/gpu", kParams};
  PluginAnswer templ_ = sift_gpu::detect(detector_, plain());
  PluginAnswer image_ = sift_gpu::detect(detector_, noisy());
  const PluginAnswer expected_ = sift_gpu::match(clean_, templ_, image_);
  // Copies in host memory, and that from which they borrow.
  const PluginAnswer templ_at_first_ = templ_, image_at_first_ = image_;
  const std::optional<Keypoints> templ_here_ = templ_at_first_.get<Keypoints>();
  const std::optional<Keypoints> image_here_ = image_at_first_.get<Keypoints>();
};

class LostMatcher : LeaksOnPurpose, public MatcherFaults {};

TEST_F(MatcherFaults, ACallThatFailsIsAnErrorOfItsFrameAndTheNextIsAsEver) {
  fail_each("match", warm(), &FaultyDriver::refuse);
}

TEST_F(MatcherFaults, SoIsOneOfItsFirstFrame) {
  fail_each("first match", first(), &FaultyDriver::refuse, {"clGetPlatformIDs", "clGetDeviceIDs"});
}

TEST_F(MatcherFaults, SoIsOneWithDescriptorsOfTheHost) {
  Frame frame = of_the_host();
  frame.get_ready = [&] { matcher_.emplace("matchers/gpu", kParams); };
  fail_each("first match of the host's", frame, &FaultyDriver::refuse,
            {"clGetPlatformIDs", "clGetDeviceIDs"});
}

TEST_F(LostMatcher, ADeviceThatIsLostAtAnyCallIsOpenedAnewForTheNextFrame) {
  fail_each("lost match of the host's", of_the_host(), &FaultyDriver::lose);
}

TEST_F(MatcherFaults, SoIsOneWhileDescriptorsOfADeviceThatWasGivenUpAreCopied) {
  Frame frame = first();
  frame.get_ready = [&] {
    detect_both();
    driver_.refuse("clEnqueueNDRangeKernel", 1, CL_OUT_OF_RESOURCES);
    EXPECT_EQ(match().status, WEFT_ERROR);
    driver_.work();
    EXPECT_EQ(sift_gpu::detect(detector_, plain()).status, WEFT_OK) << "which opens it anew";
  };
  fail_each("match across devices", frame, &FaultyDriver::refuse,
            {"clGetPlatformIDs", "clGetDeviceIDs"});
}

TEST_F(LostMatcher, TheTemplateOfALostDeviceIsAnErrorOfEveryFrameAndTheNextRunWorks) {
  match();
  driver_.lose("clEnqueueNDRangeKernel", 5, CL_OUT_OF_RESOURCES);
  expect_cause(sift_gpu::detect(detector_, noisy()), "clEnqueueNDRangeKernel", CL_OUT_OF_RESOURCES);
  driver_.work();
  for (int frame = 0; frame < 3; ++frame) {
    image_ = sift_gpu::detect(detector_, noisy());
    EXPECT_EQ(image_.status, WEFT_OK) << image_.message;
    const PluginAnswer outcome = match();
    expect_cause(outcome, "", CL_OUT_OF_RESOURCES);
    EXPECT_THAT(outcome.message, HasSubstr("lost with their device; start the run again"));
  }
  PluginUnderTest detector("detectors/sift_gpu"), matcher("matchers/gpu", kParams);
  const PluginAnswer templ = sift_gpu::detect(detector, plain());
  const PluginAnswer image = sift_gpu::detect(detector, noisy());
  EXPECT_TRUE(same_matches(sift_gpu::match(matcher, templ, image), expected_));
}

TEST_F(MatcherFaults, AWaitThatNeverEndsIsCancelledWithItsCall) {
  match();
  driver_.work();
  match();
  const int waits = driver_.calls("clGetEventInfo");
  ASSERT_GE(waits, 3) << "for the image's descriptors, the pairs and the best queries";
  for (int n = 1; n <= waits; ++n) {
    driver_.hang(n);
    const PluginAnswer cancelled = cancelled_while_hanging(*matcher_, [&] { return match(); });
    EXPECT_EQ(cancelled.status, WEFT_CANCELLED) << n;
    EXPECT_EQ(cancelled.code, Errc::cancelled) << n;
    driver_.work();
    EXPECT_TRUE(same_matches(match(), expected_)) << n;
  }
}

TEST_F(LostMatcher, ADeviceThatIsLostWhileACancelledWaitHangsIsOpenedAnew) {
  const Frame frame = of_the_host();
  frame.get_ready();
  driver_.hang(1);
  EXPECT_EQ(cancelled_while_hanging(*matcher_, frame.run).status, WEFT_CANCELLED);
  driver_.lose("clEnqueueNDRangeKernel", 1, CL_OUT_OF_RESOURCES);
  expect_cause(frame.run(), "clEnqueueNDRangeKernel", CL_OUT_OF_RESOURCES);
  for (int n = 0; n < 3; ++n) frame.expect_next_as_ever();
}

TEST_F(MatcherFaults, ACopyForAMatcherOnTheProcessorIsCancelledWithItsCall) {
  PluginUnderTest descriptor("matchers/descriptor", kParams);
  detect_both();
  driver_.hang(1);
  const PluginAnswer cancelled = cancelled_while_hanging(
      descriptor, [&] { return sift_gpu::match(descriptor, templ_, image_); });
  EXPECT_EQ(cancelled.status, WEFT_CANCELLED);
  driver_.work();
  EXPECT_EQ(sift_gpu::match(descriptor, templ_, image_).status, WEFT_OK);
}

}  // namespace
}  // namespace weft::sift_gpu
