// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <fstream>

#include "sift_gpu_alone.hpp"

namespace weft::sift_gpu {
namespace {

constexpr double kMib = 1024.0 * 1024.0;
// Sanitizers keep what was freed, and see leaks themselves.
#if defined(WEFT_SANITIZED)
constexpr bool kMeasured = false;
constexpr int kFrames = 300;
#else
constexpr bool kMeasured = true;
constexpr int kFrames = 10000;
#endif
constexpr int kWarm = kFrames / 5;

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  double size = 0.0, resident = 0.0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / kMib;
}

TEST(SiftGpuPlugin, TenThousandFramesDoNotMakeThemGrow) {
  PluginUnderTest plugin("detectors/sift_gpu"), matcher("matchers/gpu");
  const Image image = texture(64, 48, 87);
  const PluginAnswer first = detect(plugin, image);
  double warm_mib = 0.0;
  for (int frame = 1; frame < kFrames; ++frame) {
    const PluginAnswer outcome = detect(plugin, image);
    const PluginAnswer matches =
        matcher.process(0, {outcome.hand_on("keypoints", "keypoints"),
                            first.hand_on("keypoints", "template_keypoints")});
    if (frame % 1000 == 0) {
      EXPECT_TRUE(same_keypoints(outcome, first)) << frame;
      EXPECT_EQ(matches.status, WEFT_OK) << matches.message;
    }
    plugin.forget();
    matcher.forget();
    if (frame == kWarm) warm_mib = resident_mib();
  }
  const auto keypoints = first.get<Keypoints>();
  const double kept_mib =
      (kFrames - kWarm) * 128.0 * static_cast<double>(keypoints->count()) / kMib;
  const double grown_mib = resident_mib() - warm_mib;
  std::printf(
      "after %d frames %.2f MiB are resident, %d more added %.2f MiB; their descriptors have "
      "%.2f MiB\n",
      kWarm, warm_mib, kFrames - kWarm, grown_mib, kept_mib);
  if (kMeasured) {
    EXPECT_LT(grown_mib, 0.05 * kept_mib);
  }
}

}  // namespace
}  // namespace weft::sift_gpu
