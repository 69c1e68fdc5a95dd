// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <functional>
#include <thread>

#include "faulty_driver.hpp"
#include "sift_gpu_alone.hpp"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace weft::sift_gpu {

/// For tests that leave transfers, which may still run, to the process.
#if defined(__SANITIZE_ADDRESS__)
using LeaksOnPurpose = __lsan::ScopedDisabler;
#else
struct LeaksOnPurpose {};
#endif

inline constexpr std::uint64_t kSeed = 91;
// If a frame has more calls of one function than kMany, only samples of them are tried.
#if defined(WEFT_SANITIZED)
inline constexpr int kMany = 6, kSamples = 3;
#else
inline constexpr int kMany = 30, kSamples = 12;
#endif

/// With enough keypoints, and few pixels for many frames.
inline Image plain() { return texture(48, 32, kSeed); }

inline PluginAnswer match(PluginUnderTest& matcher, const PluginAnswer& templ,
                          const PluginAnswer& image) {
  return matcher.process(0, {image.hand_on("keypoints", "keypoints"),
                             templ.hand_on("keypoints", "template_keypoints")});
}

/// All of 1..count, or kSamples of many, with both ends.
inline std::vector<int> sampled(int count) {
  const int samples = count <= kMany ? count : kSamples;
  std::vector<int> calls{1};
  for (int i = 1; i < samples; ++i) calls.push_back(1 + i * (count - 1) / (samples - 1));
  return calls;
}

/// Frames on a driver that fails.
class FaultsTest : public ::testing::Test {
 protected:
  FaultsTest() { driver_.work(); }
  ~FaultsTest() override { driver_.work(); }

  /// Expects what the README promises for a failure: an error of the frame with its cause.
  static void expect_cause(const PluginAnswer& outcome, const std::string& function, cl_int code) {
    EXPECT_EQ(outcome.status, WEFT_ERROR);
    EXPECT_EQ(outcome.code, Errc::plugin_failure);
    EXPECT_THAT(outcome.message, ::testing::HasSubstr(function));
    EXPECT_THAT(outcome.message,
                ::testing::HasSubstr("failed with " + std::to_string(code) + " ("));
    EXPECT_THAT(outcome.message, ::testing::HasSubstr(" while "));
  }

  struct Frame {
    std::function<void()> get_ready;
    std::function<PluginAnswer()> run;
    std::function<void()> expect_next_as_ever;
  };
  using Fail = void (FaultyDriver::*)(const std::string&, int, cl_int);

  /// Counts the driver calls of a clean frame, and makes each of them `fail` in turn, except for
  /// the functions in `but`.
  void fail_each(const char* what, const Frame& frame, Fail fail,
                 const std::set<std::string>& but = {}) {
    constexpr cl_int kCodes[] = {CL_OUT_OF_RESOURCES, CL_MEM_OBJECT_ALLOCATION_FAILURE,
                                 CL_OUT_OF_HOST_MEMORY, CL_INVALID_COMMAND_QUEUE};
    frame.get_ready();
    driver_.work();
    const PluginAnswer clean = frame.run();
    ASSERT_EQ(clean.status, WEFT_OK) << clean.message;
    auto calls = driver_.calls();
    calls.erase("clReleaseCommandQueue");
    for (const std::string& function : but) calls.erase(function);
    int failed = 0, made = 0;
    for (const auto& [function, count] : calls) {
      made += count;
      for (const int n : sampled(count)) {
        SCOPED_TRACE(function + " fails at call " + std::to_string(n) + " of " +
                     std::to_string(count));
        frame.get_ready();
        const cl_int code = kCodes[failed++ % std::size(kCodes)];
        (driver_.*fail)(function, n, code);
        expect_cause(frame.run(), function, code);
        driver_.work();
        frame.expect_next_as_ever();
        if (HasFailure()) return;
      }
    }
    std::printf("%s: %d of %d calls failed in turn, of %zu functions\n", what, failed, made,
                calls.size());
  }

  /// A call that its host cancels once the driver has put it off a few times.
  PluginAnswer cancelled_while_hanging(PluginUnderTest& plugin,
                                       const std::function<PluginAnswer()>& call) {
    std::jthread host([&](const std::stop_token& over) {
      while (driver_.put_off() < 3 && !over.stop_requested()) std::this_thread::yield();
      plugin.cancel() = !over.stop_requested();
    });
    PluginAnswer outcome = call();
    host.request_stop();
    host.join();
    plugin.cancel() = false;
    return outcome;
  }

  FaultyDriver& driver_ = FaultyDriver::get();
};

}  // namespace weft::sift_gpu
