// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/core/params.hpp>
#include <weft/sdk/call.hpp>

#include "device.hpp"

namespace weft::sift_gpu {

/// Which device a component computes on, and what it does without one.
class DeviceChoice {
 public:
  /// Declares `device` and `without_device`.
  void read(Params& p);

  /// Checks before the first frame that a device exists, or that the pipeline permits the fallback.
  Result<void> prepare();

  /// The device, opened where it is not open. Null where there is none and the component should
  /// stand back for its `fallback`.
  Result<std::shared_ptr<Device>> open();

  /// The result of the fallback, marked as such and with its reason, also as a warning of the run.
  template <class RecordType>
  Result<RecordType> flagged(const Call& call, Result<RecordType> answer) const {
    call.log_warning(reason_ + "; its fallback answered");
    const std::string by = "found by the fallback: " + reason_;
    if (!answer) {
      Error error = answer.error();
      error.message += " (not " + by + ")";
      return error;
    }
    const std::string its_reason = answer.degenerate_reason();
    return degenerate(*std::move(answer), its_reason.empty() ? by : its_reason + "; " + by);
  }

  /// After a failure: the next open() opens the device anew, for all components on it.
  void give_up() { device_->retire(); }

 private:
  enum class WithoutDevice { error, fallback };

  std::string wanted_;
  WithoutDevice without_device_ = WithoutDevice::error;
  std::shared_ptr<Device> device_;
  bool has_no_device_ =
      false;  ///< there was none before the first frame: it is not looked for again
  std::string reason_;
};

}  // namespace weft::sift_gpu
