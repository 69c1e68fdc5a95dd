// SPDX-License-Identifier: Apache-2.0
#include "sift_gpu_faults.hpp"

#include "host/records/record.hpp"

namespace weft::sift_gpu {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class DetectorFaults : public FaultsTest {
 protected:
  // The copy is made here: its device is lost in some tests.
  DetectorFaults() { EXPECT_TRUE(expected_.get<Keypoints>()); }

  PluginAnswer detect() {
    detector_.forget();
    return sift_gpu::detect(detector_, image_);
  }
  /// Makes the next frame open the device anew.
  void lose_device() {
    driver_.refuse("clEnqueueNDRangeKernel", 1, CL_OUT_OF_RESOURCES);
    EXPECT_EQ(detect().status, WEFT_ERROR);
    driver_.work();
  }
  Frame warm() {
    return {[&] { detect(); }, [&] { return detect(); },
            [&] { EXPECT_TRUE(same_keypoints(detect(), expected_)); }};
  }
  Frame first() {
    Frame frame = warm();
    frame.get_ready = [&] { lose_device(); };
    return frame;
  }

  Image image_ = plain();
  PluginUnderTest clean_{"detectors/sift_gpu"}, detector_{"detectors/sift_gpu"};
  PluginAnswer expected_ = sift_gpu::detect(clean_, image_);
};

class LostDetector : LeaksOnPurpose, public DetectorFaults {};

TEST_F(DetectorFaults, ACallThatFailsIsAnErrorOfItsFrameAndTheNextIsAsEver) {
  fail_each("frame", warm(), &FaultyDriver::refuse);
}

TEST_F(DetectorFaults, SoIsOneWhileTheDeviceIsOpened) {
  // The two of the programs are spared: a cached one that is refused is compiled again.
  fail_each("first frame", first(), &FaultyDriver::refuse,
            {"clGetPlatformIDs", "clGetDeviceIDs", "clCreateProgramWithBinary", "clBuildProgram"});
}

TEST_F(LostDetector, ADeviceThatIsLostAtAnyCallIsOpenedAnewForTheNextFrame) {
  fail_each("lost", warm(), &FaultyDriver::lose, {"clGetMemObjectInfo"});
}

TEST_F(DetectorFaults, ACopyThatFailsSaysWhyAndTheNextSucceeds) {
  PluginAnswer there;
  const auto copy = [&]() -> PluginAnswer {
    const auto here = there.outputs.front().second->in_host_memory();
    if (here) return {};
    return {WEFT_ERROR, here.error().code, here.error().message, {}, {}};
  };
  fail_each(
      "copy",
      {[&] { there = detect(); }, copy, [&] { EXPECT_TRUE(same_keypoints(there, expected_)); }},
      &FaultyDriver::refuse);
}

TEST_F(DetectorFaults, ACachedProgramThatIsRefusedIsCompiledAgain) {
  for (const char* function : {"clCreateProgramWithBinary", "clBuildProgram"}) {
    lose_device();
    driver_.refuse(function, 1, CL_INVALID_BINARY);
    EXPECT_TRUE(same_keypoints(detect(), expected_)) << function;
    EXPECT_EQ(driver_.calls("clCreateProgramWithSource"), 1) << function;
  }
}

TEST_F(DetectorFaults, KernelsThatCannotBeBuiltAreAnErrorWithTheCause) {
  lose_device();
  driver_.refuse_all("clBuildProgram", CL_BUILD_PROGRAM_FAILURE);
  const PluginAnswer outcome = detect();
  EXPECT_EQ(outcome.status, WEFT_ERROR);
  EXPECT_EQ(outcome.code, Errc::unsupported);
  EXPECT_THAT(outcome.message, HasSubstr("the kernels do not compile on "));
  driver_.refuse_all("clBuildProgram", CL_OUT_OF_HOST_MEMORY);
  expect_cause(detect(), "clBuildProgram", CL_OUT_OF_HOST_MEMORY);
  driver_.work();
  EXPECT_TRUE(same_keypoints(detect(), expected_));
}

TEST_F(DetectorFaults, AWaitThatNeverEndsIsCancelledWithItsCallAndLetGoOnceItEnds) {
  detect();
  driver_.work();
  detect();
  const int waits = driver_.calls("clGetEventInfo");
  ASSERT_EQ(waits, 3) << "for two counts and the keypoints";
  for (int n = 1; n <= waits; ++n) {
    driver_.hang(n);
    const PluginAnswer cancelled = cancelled_while_hanging(detector_, [&] { return detect(); });
    EXPECT_EQ(cancelled.status, WEFT_CANCELLED) << n;
    EXPECT_EQ(cancelled.code, Errc::cancelled) << n;
    const PluginAnswer meanwhile = detect();
    EXPECT_EQ(driver_.calls("clReleaseCommandQueue"), 0) << "what may be written to is kept";
    EXPECT_TRUE(same_keypoints(meanwhile, expected_));
    driver_.work();
    const PluginAnswer afterwards = detect();
    EXPECT_EQ(driver_.calls("clReleaseCommandQueue"), 1) << "and let go";
    EXPECT_TRUE(same_keypoints(afterwards, expected_));
  }
}

TEST_F(DetectorFaults, AnImageOfAnotherSizeDoesNotWaitForDescriptorsThatAreStillComputed) {
  const Image other = texture(64, 40, kSeed);
  detector_.forget();
  EXPECT_EQ(sift_gpu::detect(detector_, other).status, WEFT_OK);
  driver_.hang(1);
  const PluginAnswer meanwhile = detect();
  EXPECT_GT(driver_.put_off(), 0) << "the descriptors of the other image";
  EXPECT_EQ(driver_.calls("clReleaseCommandQueue"), 0) << "what may be written to is kept";
  EXPECT_TRUE(same_keypoints(meanwhile, expected_));
  driver_.work();
  const PluginAnswer afterwards = detect();
  EXPECT_EQ(driver_.calls("clReleaseCommandQueue"), 1) << "and let go";
  EXPECT_TRUE(same_keypoints(afterwards, expected_));
}

TEST_F(LostDetector, ADeviceThatIsLostWhileACancelledWaitHangsIsOpenedAnew) {
  detect();
  driver_.hang(1);
  EXPECT_EQ(cancelled_while_hanging(detector_, [&] { return detect(); }).status, WEFT_CANCELLED);
  driver_.lose("clEnqueueNDRangeKernel", 1, CL_OUT_OF_RESOURCES);
  expect_cause(detect(), "clEnqueueNDRangeKernel", CL_OUT_OF_RESOURCES);
  for (int frame = 0; frame < 3; ++frame) {
    const PluginAnswer outcome = detect();
    EXPECT_TRUE(same_keypoints(outcome, expected_)) << frame << ": " << outcome.message;
  }
}

TEST_F(LostDetector, ACancelledDetectorMayBeEndedWhileItsWaitHangs) {
  {
    PluginUnderTest ended("detectors/sift_gpu");
    sift_gpu::detect(ended, image_);
    driver_.hang(2);
    const PluginAnswer cancelled =
        cancelled_while_hanging(ended, [&] { return sift_gpu::detect(ended, image_); });
    EXPECT_EQ(cancelled.status, WEFT_CANCELLED);
  }
  EXPECT_TRUE(same_keypoints(detect(), expected_));
}

TEST_F(DetectorFaults, DriversThatCannotNameTheirDevicesAreAnErrorWithTheCause) {
  for (const char* function : {"clGetPlatformIDs", "clGetDeviceIDs"}) {
    lose_device();
    driver_.refuse_all(function, CL_OUT_OF_HOST_MEMORY);
    const PluginAnswer outcome = detect();
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_THAT(outcome.message, AllOf(HasSubstr("there is no OpenCL device"),
                                       HasSubstr(std::string(function) + " failed with -6 (")));
    driver_.work();
    EXPECT_TRUE(same_keypoints(detect(), expected_));
  }
}

TEST_F(DetectorFaults, TheFallbackAnswersWhileALostDeviceCannotBeOpened) {
  PluginUnderTest detector("detectors/sift_gpu", "{without_device: fallback}");
  EXPECT_TRUE(same_keypoints(sift_gpu::detect(detector, image_), expected_));
  lose_device();
  driver_.refuse_all("clCreateContext", CL_DEVICE_NOT_AVAILABLE);
  const PluginAnswer found = sift_gpu::detect(detector, image_);
  EXPECT_EQ(found.status, WEFT_DEGENERATE);
  EXPECT_THAT(found.message, HasSubstr("found by the fallback: clCreateContext failed with -2 ("));
  driver_.work();
  EXPECT_TRUE(same_keypoints(sift_gpu::detect(detector, image_), expected_));
}

/// A machine whose loader finds no driver, or whose drivers find no device.
class NoDevice : public DetectorFaults, public ::testing::WithParamInterface<const char*> {
 protected:
  void take_away() {
    lose_device();
    driver_.refuse_all(GetParam(), std::string(GetParam()) == "clGetDeviceIDs"
                                       ? CL_DEVICE_NOT_FOUND
                                       : CL_PLATFORM_NOT_FOUND_KHR);
  }
};

TEST_P(NoDevice, IsAnErrorThatSaysWhatToInstallUntilThereIsOne) {
  take_away();
  for (int frame = 0; frame < 2; ++frame) {
    const PluginAnswer outcome = detect();
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_EQ(outcome.code, Errc::not_found);
    EXPECT_THAT(outcome.message,
                AllOf(HasSubstr("there is no OpenCL device; install the driver of the GPU"),
                      HasSubstr("pocl-opencl-icd"), HasSubstr("without_device: fallback")));
  }
  driver_.work();
  EXPECT_TRUE(same_keypoints(detect(), expected_));
}

TEST_P(NoDevice, TheFallbackAnswersAndItsFramesAreFlaggedUntilThereIsOne) {
  const std::string params = "{without_device: fallback}";
  PluginUnderTest detector("detectors/sift_gpu", params), matcher("matchers/gpu", params);
  PluginUnderTest sift("detectors/sift"), descriptor("matchers/descriptor");
  const PluginAnswer sifted = sift_gpu::detect(sift, image_);
  take_away();
  for (int frame = 0; frame < 2; ++frame) {
    const PluginAnswer found = sift_gpu::detect(detector, image_);
    EXPECT_EQ(found.status, WEFT_DEGENERATE);
    EXPECT_THAT(found.message, HasSubstr("found by the fallback: there is no OpenCL device"));
    EXPECT_EQ(found.get<Keypoints>()->count(), sifted.get<Keypoints>()->count());
    const PluginAnswer matched = sift_gpu::match(matcher, found, found);
    EXPECT_EQ(matched.status, WEFT_DEGENERATE);
    EXPECT_THAT(matched.message, HasSubstr("found by the fallback: there is no OpenCL device"));
    EXPECT_EQ(matched.get<Correspondences>()->count(),
              sift_gpu::match(descriptor, sifted, sifted).get<Correspondences>()->count());
  }
  driver_.work();
  EXPECT_TRUE(same_keypoints(sift_gpu::detect(detector, image_), expected_));
  EXPECT_EQ(sift_gpu::match(matcher, expected_, expected_).status, WEFT_OK);
}

INSTANTIATE_TEST_SUITE_P(At, NoDevice, ::testing::Values("clGetPlatformIDs", "clGetDeviceIDs"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace weft::sift_gpu
