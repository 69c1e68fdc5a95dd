// SPDX-License-Identifier: Apache-2.0
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <CL/cl_ext.h>

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

namespace weft::sift_gpu {

/// The driver of this machine with faults on demand. This program defines functions of OpenCL
/// itself. They take precedence over the loader's functions, also in the libraries that the program
/// loads, and consult this class before they forward a call. Only return values are false: a
/// forwarded call is executed.
class FaultyDriver {
 public:
  static FaultyDriver& get();

  /// The n-th call of a function, counted from now on, answers `code`.
  void refuse(const std::string& function, int nth, cl_int code) {
    plan(Fault{function, nth, code, Fault::once});
  }
  /// Every call of it does.
  void refuse_all(const std::string& function, cl_int code) {
    plan(Fault{function, 1, code, Fault::always});
  }
  /// With the n-th call of a function its context is lost. Every later call on that context, its
  /// programs, queues and events returns `code`.
  void lose(const std::string& function, int nth, cl_int code) {
    plan(Fault{function, nth, code, Fault::lost});
  }
  /// The driver reports the event of the n-th wait, counted from now on, as running until work().
  void hang(int nth_wait) { plan(Fault{kWait, nth_wait, CL_RUNNING, Fault::hangs}); }

  /// No more faults, and counts from nothing; what was lost stays so. Waits until the commands that
  /// were reported as running have ended.
  void work();

  /// Counted calls of each function. A wait polls the same event repeatedly, which counts as one
  /// call of clGetEventInfo.
  std::map<std::string, int> calls() const;
  int calls(const std::string& function) const;
  /// How often the driver reported the event of hang() as running.
  int put_off() const;

  /// The return value for a call that concerns `context`; CL_SUCCESS: the call is forwarded.
  cl_int refusal(const std::string& function, cl_context context);
  /// Likewise for a question about an event; CL_RUNNING is no refusal.
  cl_int refusal(cl_event event, cl_context context);

 private:
  static constexpr const char* kWait = "clGetEventInfo";
  struct Fault {
    enum Kind { once, always, lost, hangs };
    std::string function;
    int nth = 0;
    cl_int code = CL_SUCCESS;
    Kind kind = once;
  };
  void plan(std::optional<Fault> fault);
  cl_int answer(const std::string& function, bool counted, cl_context context);

  mutable std::mutex mutex_;
  std::optional<Fault> fault_;
  std::map<std::string, int> calls_;
  cl_event asked_ = nullptr;  ///< by the last call, where that was a wait
  // Held, so that nothing new gets the place of what was lost or hangs.
  std::map<cl_context, cl_int> lost_;
  std::set<cl_event> hanging_;
  int put_off_ = 0;
};

}  // namespace weft::sift_gpu
