// SPDX-License-Identifier: Apache-2.0
#include "capture_devices.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <tuple>

namespace weft::capture_devices {
namespace {

constexpr unsigned kMostEntries = 256;  // for drivers that never end a list
constexpr double kExposureUnits_per_ms = 10.0;

class DevicesOfMachine final : public DeviceAccess {
 public:
  std::vector<int> numbers() const override {
    constexpr std::string_view kStem = "video";
    std::vector<int> numbers;
    std::error_code status;
    for (const auto& entry : std::filesystem::directory_iterator("/dev", status)) {
      const std::string name = entry.path().filename().string();
      int number = 0;
      const char* const end = name.data() + name.size();
      if (!name.starts_with(kStem)) continue;
      const auto read = std::from_chars(name.data() + kStem.size(), end, number);
      if (read.ec == std::errc() && read.ptr == end) numbers.push_back(number);
    }
    std::sort(numbers.begin(), numbers.end());
    return numbers;
  }
  int open(int number) const override {
    const std::string path = "/dev/video" + std::to_string(number);
    return ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  }
  int control(int device, unsigned long request, void* argument) const override {
    int answer = -1;
    do {
      answer = ioctl(device, request, argument);
    } while (answer < 0 && errno == EINTR);
    return answer;
  }
  void close(int device) const override { ::close(device); }
};

/// An open device.
class Opened {
 public:
  Opened(const DeviceAccess& access, int number) : access_(access), device_(access.open(number)) {}
  ~Opened() {
    if (device_ >= 0) access_.close(device_);
  }
  Opened(const Opened&) = delete;
  Opened& operator=(const Opened&) = delete;

  explicit operator bool() const { return device_ >= 0; }
  template <class Argument>
  bool ask(unsigned long request, Argument& argument) const {
    return access_.control(device_, request, &argument) >= 0;
  }

 private:
  const DeviceAccess& access_;
  int device_;
};

std::string format_name(std::uint32_t code) {
  std::string name;
  for (unsigned shift = 0; shift < 32; shift += 8) {
    name += static_cast<char>(code >> shift & 0x7FU);
  }
  return name;
}

/// The highest frame rate of a mode, or 0.
double fastest(const Opened& device, std::uint32_t format, std::uint32_t width,
               std::uint32_t height) {
  double fps = 0.0;
  for (unsigned i = 0; i < kMostEntries; ++i) {
    v4l2_frmivalenum interval{};
    interval.index = i;
    interval.pixel_format = format;
    interval.width = width;
    interval.height = height;
    if (!device.ask(VIDIOC_ENUM_FRAMEINTERVALS, interval)) break;
    const bool is_one = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE;
    const v4l2_fract& least = is_one ? interval.discrete : interval.stepwise.min;
    if (least.numerator > 0) fps = std::max(fps, 1.0 * least.denominator / least.numerator);
    if (!is_one) break;
  }
  return fps;
}

/// The sizes of a range: the usual ones within it, and its largest.
std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes_within(
    const v4l2_frmsize_stepwise& range) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes{{range.max_width, range.max_height}};
  for (const auto& [width, height] : {std::pair{320U, 240U},
                                      {640U, 480U},
                                      {800U, 600U},
                                      {1280U, 720U},
                                      {1920U, 1080U},
                                      {3840U, 2160U}}) {
    const auto fits = [](std::uint32_t side, std::uint32_t least, std::uint32_t most,
                         std::uint32_t step) {
      return side >= least && side <= most && (side - least) % std::max(step, 1U) == 0;
    };
    const bool is_largest = std::pair{width, height} == sizes.front();
    if (!is_largest && fits(width, range.min_width, range.max_width, range.step_width) &&
        fits(height, range.min_height, range.max_height, range.step_height)) {
      sizes.emplace_back(width, height);
    }
  }
  return sizes;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes_of(const Opened& device,
                                                              std::uint32_t format) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sizes;
  for (unsigned i = 0; i < kMostEntries; ++i) {
    v4l2_frmsizeenum size{};
    size.index = i;
    size.pixel_format = format;
    if (!device.ask(VIDIOC_ENUM_FRAMESIZES, size)) break;
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) return sizes_within(size.stepwise);
    sizes.emplace_back(size.discrete.width, size.discrete.height);
  }
  return sizes;
}

std::vector<Mode> modes_of(const Opened& device) {
  std::vector<Mode> modes;
  for (unsigned i = 0; i < kMostEntries; ++i) {
    v4l2_fmtdesc format{};
    format.index = i;
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!device.ask(VIDIOC_ENUM_FMT, format)) break;
    for (const auto& [width, height] : sizes_of(device, format.pixelformat)) {
      modes.push_back({format_name(format.pixelformat), static_cast<int>(width),
                       static_cast<int>(height),
                       fastest(device, format.pixelformat, width, height)});
    }
  }
  std::stable_sort(modes.begin(), modes.end(), [](const Mode& a, const Mode& b) {
    return std::tuple(a.width_px * a.height_px, a.fps) >
           std::tuple(b.width_px * b.height_px, b.fps);
  });
  return modes;
}

std::optional<std::pair<double, double>> exposure_of(const Opened& device) {
  v4l2_queryctrl range{};
  range.id = V4L2_CID_EXPOSURE_ABSOLUTE;
  if (!device.ask(VIDIOC_QUERYCTRL, range) || (range.flags & V4L2_CTRL_FLAG_DISABLED) != 0) {
    return std::nullopt;
  }
  return std::pair{range.minimum / kExposureUnits_per_ms, range.maximum / kExposureUnits_per_ms};
}

/// The device, or nothing if it is no camera.
std::optional<Device> device_of(const DeviceAccess& access, int number) {
  Device found;
  found.number = number;
  found.name = "/dev/video" + std::to_string(number);
  const Opened device(access, number);
  if (!device) {
    found.fault = errno == EACCES ? "not readable: add yourself to the group video"
                                  : std::string("cannot be opened: ") + std::strerror(errno);
    return found;
  }
  v4l2_capability capability{};
  if (!device.ask(VIDIOC_QUERYCAP, capability)) return std::nullopt;
  const bool is_by_node = (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0;
  const std::uint32_t can = is_by_node ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0) return std::nullopt;
  const auto* const card = reinterpret_cast<const char*>(capability.card);
  found.name = std::string(card, strnlen(card, sizeof capability.card));
  found.modes = modes_of(device);
  found.exposure_ms = exposure_of(device);
  return found;
}

}  // namespace

const DeviceAccess& devices_of_machine() {
  static const DevicesOfMachine devices;
  return devices;
}

std::vector<Device> list_devices(const DeviceAccess& access) {
  std::vector<Device> devices;
  for (const int number : access.numbers()) {
    if (auto device = device_of(access, number)) devices.push_back(*std::move(device));
  }
  return devices;
}

}  // namespace weft::capture_devices
