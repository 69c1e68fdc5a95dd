// SPDX-License-Identifier: Apache-2.0
#include "camera/calibrator.hpp"

namespace weft::live {
namespace {

class NoCalibrator final : public Calibrator {
 public:
  std::string ask(std::string_view /*request*/) override {
    return "this Weft was built without OpenCV's module aruco: install libopencv-contrib-dev and "
           "build again";
  }
  bool wants_frame() const override { return false; }
  void put_frame(const Array<std::uint8_t>& /*pixels*/, std::uint64_t /*frame*/) override {}
};

}  // namespace

std::unique_ptr<Calibrator> make_calibrator(std::string /*file*/,
                                            std::function<void(std::string)> /*report*/) {
  return std::make_unique<NoCalibrator>();
}

}  // namespace weft::live
