// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <weft/data/array.hpp>

namespace weft::live {

/// Calibrates the camera of the run from frames that show the board of `weft calibrate`, while a
/// client requests it. The work is done in a separate thread, on the newest frame.
class Calibrator {
 public:
  virtual ~Calibrator() = default;
  /// A request of a client: "begin BOARD", where BOARD is a JSON object with the options of
  /// `weft calibrate` (pattern, squares, square_m, dictionary, marker_share), "end COEFFICIENTS" or
  /// "stop". Returns why it is refused; empty if it is granted. From any thread.
  virtual std::string ask(std::string_view request) = 0;
  /// True if put_frame() has a use for the next frame.
  virtual bool wants_frame() const = 0;
  /// [H,W] or [H,W,3] grey levels or BGR, of an image without undistortion; copied.
  virtual void put_frame(const Array<std::uint8_t>& pixels, std::uint64_t frame) = 0;
};

/// `report` receives each state as a JSON object, with the members of the message `calibration`;
/// from any thread. The camera file is written to `file`, unless that is empty.
std::unique_ptr<Calibrator> make_calibrator(std::string file,
                                            std::function<void(std::string)> report);

}  // namespace weft::live
