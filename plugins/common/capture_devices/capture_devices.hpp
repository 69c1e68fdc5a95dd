// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

/// The cameras that are connected to this machine, by Video4Linux (V4L2).
namespace weft::capture_devices {

/// A size and pixel format that a camera sends.
struct Mode {
  std::string format;  ///< four characters, such as MJPG
  int width_px = 0, height_px = 0;
  double fps = 0.0;  ///< [1/s] highest frame rate; 0: unknown
};

struct Device {
  int number = 0;                                        ///< N of /dev/videoN
  std::string name;                                      ///< the driver's, such as "HD Webcam"
  std::vector<Mode> modes;                               ///< larger ones first
  std::optional<std::pair<double, double>> exposure_ms;  ///< [ms] range, where it can be set
  std::string fault;  ///< why nothing else is known; empty for a camera that can be read
};

/// How devices are reached; tests replace it.
class DeviceAccess {
 public:
  virtual ~DeviceAccess() = default;
  /// The N of all /dev/videoN, ascending.
  virtual std::vector<int> numbers() const = 0;
  /// As open(2), ioctl(2) and close(2): below 0 with errno on a failure.
  virtual int open(int number) const = 0;
  virtual int control(int device, unsigned long request, void* argument) const = 0;
  virtual void close(int device) const = 0;
};

const DeviceAccess& devices_of_machine();

/// All cameras, also those that another program uses: they can be listed, but not read. Other
/// devices, such as those for metadata, are omitted.
std::vector<Device> list_devices(const DeviceAccess& access = devices_of_machine());

}  // namespace weft::capture_devices
