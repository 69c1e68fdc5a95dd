// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <memory>

#include "device.hpp"

namespace weft::sift_gpu {

/// Work that was interrupted: it is kept until the device has done with it, for the device may
/// still write to its memory.
template <class Work>
class Abandoned {
 public:
  void keep(std::unique_ptr<Work> work) { works_.push_back(std::move(work)); }

  /// Releases works that have ended, and those that a lost device will never complete.
  void bury() { works_.remove_if(&is_over); }

 private:
  static bool is_over(const std::unique_ptr<Work>& work) {
    try {
      return work->idle();
    } catch (const cl::Error&) {
      return true;
    }
  }

  std::list<std::unique_ptr<Work>> works_;
};

}  // namespace weft::sift_gpu
