// SPDX-License-Identifier: Apache-2.0
#include "kit/conformance/large_inputs.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <numeric>
#include <thread>

#include "kit/conformance/probes/process_state.hpp"
#include "kit/testing/contract_materials.hpp"

namespace weft::conformance {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kWidth_px = 3840, kHeight_px = 2160;
constexpr std::int64_t kMatches = 100'000;
constexpr rlim_t kMostMemory = 16ULL << 30U;  ///< [bytes] of addresses
constexpr double kPatience_ms = 30'000.0;     ///< CPU time until the call is cancelled
constexpr double kHeadStart_ms = 20.0;        ///< time of a call before it is cancelled
constexpr int kMostWaiting = 4;               ///< times as long it may take, for it may wait
constexpr double kSoon_ms = 50.0, kLongest_ms = 2'000.0, kLongestWait_ms = 10'000.0;

/// The scene with an image and a region of the larger size, generated again.
void enlarge_image(Scene& scene, Rng& rng) {
  scene.image.pixels = Array<std::uint8_t>({kHeight_px, kWidth_px}, 128);
  testing::draw_discs(scene.image.pixels, rng);
  scene.region.mask = Array<std::uint8_t>({kHeight_px, kWidth_px}, 0);
  std::fill_n(scene.region.mask.data(), scene.region.mask.size(), std::uint8_t{1});
  const double scale = static_cast<double>(kWidth_px) / scene.camera.width_px;
  scene.camera.fx *= scale;
  scene.camera.fy *= scale;
  scene.camera.cx = kWidth_px / 2.0 - 0.5;
  scene.camera.cy = kHeight_px / 2.0 - 0.5;
  scene.camera.width_px = kWidth_px;
  scene.camera.height_px = kHeight_px;
}

/// Its matches many times over, each a little elsewhere in the image.
void multiply_matches(Scene& scene, Rng& rng) {
  const std::int64_t count = scene.matches.matches.count();
  std::vector<std::int64_t> rows(static_cast<std::size_t>(kMatches));
  for (std::int64_t i = 0; i < kMatches; ++i) rows[static_cast<std::size_t>(i)] = i % count;
  scene.take_matches(rows);
  Correspondences& all = scene.matches.matches;
  for (std::int64_t i = 0; i < kMatches; ++i) {
    for (int k = 0; k < 2; ++k) all.image_px(i, k) += 0.3 * rng.normal();
  }
  scene.follow_matches();
}

/// One call with large inputs, cancelled after some time.
struct Large {
  Answer answer;
  double took_ms = 0.0;         ///< wall-clock time of the whole call
  double after_stop_ms = -1.0;  ///< from then on, without what others took of the processor; below
                                ///< 0 where it had ended
  double busy_ms = 0.0;         ///< CPU time after the cancellation
  std::string refused;          ///< why there was no call
  bool is_unsupported = false;  ///< it refuses such a camera or template, which is legal
};

Large call_large(const Setting& setting, double until_ms) {
  Large large;
  auto play = Play::of(setting);
  if (!play) return {{}, 0.0, -1.0, 0.0, play.error().message};
  Rng rng(setting.candidate.seed);
  Scene scene = testing::make_scene(0, setting.candidate.seed);
  if ((*play)->subject().takes("image")) enlarge_image(scene, rng);
  multiply_matches(scene, rng);
  testing::Case& given = (*play)->given(0);
  given.scene = scene;
  given.inputs = testing::inputs_of((*play)->subject(), scene);
  Performer performer((*play)->subject(), {.protects_inputs = false});
  const Answer ready = (*play)->begin(performer);
  if (!ready.is_usable()) {
    return {{}, 0.0, -1.0, 0.0, to_text(ready), ready.code == Errc::unsupported};
  }
  std::atomic<bool> ended = false;
  std::atomic<double> busy_at_stop = -1.0;
  const auto ms = [](auto span) { return std::chrono::duration<double, std::milli>(span).count(); };
  const int caller = gettid();
  const double busy_at_start = processor_ms();
  const auto start = Clock::now();
  Clock::time_point stopped = start;
  double queued_at_stop = 0.0;
  const auto is_time = [&] {
    return processor_ms() - busy_at_start > until_ms ||
           ms(Clock::now() - start) > kMostWaiting * until_ms;
  };
  std::thread clock([&] {
    while (!ended && !is_time()) std::this_thread::sleep_for(milliseconds(1));
    if (ended) return;
    stopped = Clock::now();
    queued_at_stop = queued_ms(caller);
    busy_at_stop = processor_ms();
    performer.cancel() = true;
  });
  large.answer = (*play)->frame(performer, 0);
  ended = true;
  const auto end = Clock::now();
  const double busy = processor_ms(), queued = queued_ms(caller);
  clock.join();
  large.took_ms = ms(end - start);
  if (busy_at_stop < 0.0) return large;
  large.after_stop_ms = std::max(0.0, ms(end - stopped) - (queued - queued_at_stop));
  large.busy_ms = std::max(0.0, busy - busy_at_stop);
  return large;
}

bool is_large_for(const Setting& setting) {
  const auto& entry = *setting.candidate.installed();
  return rules_of(entry.component.role()).part == PipelinePart::stage;
}

constexpr const char* kNoStage = "only stages are given images and matches by the kit";

}  // namespace

void check_large(const Setting& setting, double effort, Page& page) {
  if (!is_large_for(setting)) return page.skip(kNoStage);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return page.skip("this program is sanitized, which takes more addresses than it may have");
#endif
  const rlimit limit{kMostMemory, RLIM_INFINITY};
  rlimit before{};
  getrlimit(RLIMIT_AS, &before);
  setrlimit(RLIMIT_AS, &limit);
  const double patience_ms = effort * kPatience_ms;
  const Large large = call_large(setting, patience_ms);
  setrlimit(RLIMIT_AS, &before);
  if (large.is_unsupported) return page.skip("it refuses the camera: " + large.refused);
  if (!large.refused.empty()) return page.fail("it cannot be made ready: " + large.refused);
  if (large.answer.code == Errc::no_memory) {
    return page.fail(
        "16 GiB are not enough for it: take less than the square of the number of matches, or "
        "report the largest number with which it works");
  }
  if (large.after_stop_ms < 0.0) {
    return page.note(fmt::format("{} after {:.1f} s", to_text(large.answer), large.took_ms / 1e3));
  }
  page.expect(large.after_stop_ms < kLongestWait_ms,
              fmt::format("not done after {:.0f} s, and once cancelled it goes on for {:.1f} s",
                          patience_ms / 1e3, large.after_stop_ms / 1e3));
  if (effort < 1.0) {
    return page.note(
        fmt::format("{}cancelled after {:.0f} of {:.0f} s of CPU time; stopped {:.0f} "
                    "ms later",
                    kReduced, patience_ms / 1e3, kPatience_ms / 1e3, large.after_stop_ms));
  }
  page.note(fmt::format("not done after {:.0f} s; stopped {:.0f} ms after it was cancelled",
                        patience_ms / 1e3, large.after_stop_ms));
}

void check_cancelled(const Setting& setting, Page& page) {
  if (!is_large_for(setting)) return page.skip(kNoStage);
  const Large large = call_large(setting, kHeadStart_ms);
  if (large.is_unsupported) return page.skip("it refuses the camera: " + large.refused);
  if (!large.refused.empty()) return page.fail("it cannot be made ready: " + large.refused);
  if (large.after_stop_ms < 0.0) {
    return page.note(fmt::format("done after {:.0f} ms, before it is cancelled", large.took_ms));
  }
  const double late_ms = std::max(large.busy_ms, large.after_stop_ms);
  page.expect(late_ms < kLongest_ms,
              fmt::format("it goes on for {:.0f} ms of CPU time, {:.0f} ms in all: check "
                          "weft_host.cancelled every 5 ms, also in loops of libraries",
                          large.busy_ms, large.after_stop_ms));
  page.note(fmt::format("stops after {:.0f} ms{}", late_ms,
                        late_ms > kSoon_ms ? ", more than 50 ms" : ""));
}

}  // namespace weft::conformance
