// SPDX-License-Identifier: Apache-2.0
#include "common/capture_devices/capture_devices.hpp"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cerrno>
#include <cstring>
#include <set>

namespace weft::capture_devices {
namespace {

/// A webcam at 0 with its node of metadata at 1, a camera of free sizes at 2, and one at 7 that may
/// not be opened. It answers as drivers do.
class PlayedDevices final : public DeviceAccess {
 public:
  std::vector<int> numbers() const override { return {0, 1, 2, 7}; }
  int open(int number) const override {
    if (number != 7) {
      opened_.insert(number);
      return number;
    }
    errno = EACCES;
    return -1;
  }
  void close(int device) const override { opened_.erase(device); }

  int control(int device, unsigned long request, void* argument) const override {
    EXPECT_TRUE(opened_.contains(device));
    if (request == VIDIOC_QUERYCAP) {
      auto& answer = *static_cast<v4l2_capability*>(argument);
      std::strcpy(reinterpret_cast<char*>(answer.card), device == 2 ? "Free" : "HD Webcam");
      answer.capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE;
      answer.device_caps = device == 1 ? V4L2_CAP_META_CAPTURE : V4L2_CAP_VIDEO_CAPTURE;
      return 0;
    }
    if (request == VIDIOC_ENUM_FMT) {
      auto& answer = *static_cast<v4l2_fmtdesc*>(argument);
      const std::uint32_t formats[] = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
      if (answer.index >= (device == 2 ? 1U : 2U)) return end();
      answer.pixelformat = formats[answer.index];
      return 0;
    }
    if (request == VIDIOC_ENUM_FRAMESIZES) {
      auto& answer = *static_cast<v4l2_frmsizeenum*>(argument);
      if (device == 2) {
        if (answer.index > 0) return end();
        answer.type = V4L2_FRMSIZE_TYPE_STEPWISE;
        answer.stepwise = {320, 2000, 8, 200, 1500, 2};
        return 0;
      }
      if (answer.index > 1) return end();
      answer.type = V4L2_FRMSIZE_TYPE_DISCRETE;
      answer.discrete =
          answer.index == 0 ? v4l2_frmsize_discrete{640, 480} : v4l2_frmsize_discrete{1280, 720};
      return 0;
    }
    if (request == VIDIOC_ENUM_FRAMEINTERVALS) {
      auto& answer = *static_cast<v4l2_frmivalenum*>(argument);
      if (device == 2 || answer.index > 1) return end();
      const bool is_slow = answer.pixel_format == V4L2_PIX_FMT_YUYV && answer.width == 1280;
      answer.type = V4L2_FRMIVAL_TYPE_DISCRETE;
      answer.discrete = {1, is_slow ? 10U - answer.index : 15U + 15U * answer.index};
      return 0;
    }
    if (request == VIDIOC_QUERYCTRL && device == 0) {
      auto& answer = *static_cast<v4l2_queryctrl*>(argument);
      EXPECT_EQ(answer.id, V4L2_CID_EXPOSURE_ABSOLUTE);
      answer.minimum = 3;
      answer.maximum = 2047;
      return 0;
    }
    return end();
  }

  bool all_closed() const { return opened_.empty(); }

 private:
  static int end() {
    errno = EINVAL;
    return -1;
  }
  mutable std::set<int> opened_;
};

TEST(CaptureDevices, ListsCamerasWithTheirModesAndOmitsOtherDevices) {
  const PlayedDevices played;
  const std::vector<Device> devices = list_devices(played);
  ASSERT_EQ(devices.size(), 3U);
  const Device& webcam = devices[0];
  EXPECT_EQ(webcam.number, 0);
  EXPECT_EQ(webcam.name, "HD Webcam");
  EXPECT_EQ(webcam.fault, "");
  ASSERT_EQ(webcam.modes.size(), 4U);
  EXPECT_EQ(webcam.modes[0].format, "MJPG");  // faster than YUYV of the same size
  EXPECT_EQ(webcam.modes[0].width_px, 1280);
  EXPECT_EQ(webcam.modes[0].height_px, 720);
  EXPECT_EQ(webcam.modes[0].fps, 30.0);
  EXPECT_EQ(webcam.modes[1].format, "YUYV");
  EXPECT_EQ(webcam.modes[1].fps, 10.0);
  EXPECT_EQ(webcam.modes[3].width_px, 640);
  ASSERT_TRUE(webcam.exposure_ms);
  EXPECT_DOUBLE_EQ(webcam.exposure_ms->first, 0.3);
  EXPECT_DOUBLE_EQ(webcam.exposure_ms->second, 204.7);
  EXPECT_TRUE(played.all_closed());
}

TEST(CaptureDevices, OffersUsualSizesWithinARangeAndItsLargest) {
  const std::vector<Device> devices = list_devices(PlayedDevices());
  const Device& camera = devices.at(1);
  std::vector<int> widths_px;
  for (const Mode& mode : camera.modes) widths_px.push_back(mode.width_px);
  EXPECT_EQ(widths_px, (std::vector{2000, 1920, 1280, 800, 640, 320}));
  EXPECT_EQ(camera.modes[0].fps, 0.0);
  EXPECT_FALSE(camera.exposure_ms);
}

TEST(CaptureDevices, ExplainWhyOneCannotBeOpened) {
  const Device closed = list_devices(PlayedDevices()).at(2);
  EXPECT_EQ(closed.number, 7);
  EXPECT_EQ(closed.name, "/dev/video7");
  EXPECT_NE(closed.fault.find("group video"), std::string::npos);
  EXPECT_TRUE(closed.modes.empty());
}

}  // namespace
}  // namespace weft::capture_devices
