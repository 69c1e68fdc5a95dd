// SPDX-License-Identifier: Apache-2.0
#include "cli/track/focal_measurement.hpp"

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "cli/ending/interruption.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kMostUncertain = 0.06;  // relative to the focal length

class Silent final : public RunObserver {
 public:
  void started(std::int64_t /*frames*/) override {}
  void frame_done(const FrameResult& /*frame*/) override {}
};

double figure(const RunSummary& summary, std::string_view name) {
  const auto found = std::find_if(summary.camera.begin(), summary.camera.end(),
                                  [&](const auto& entry) { return entry.first == name; });
  return found == summary.camera.end() ? 0.0 : found->second;
}

}  // namespace

std::optional<FocalMeasurement> measure_focal(const std::string& pipeline,
                                              const std::vector<std::string>& settings,
                                              const std::string& scratch, Context& context) {
  const auto registry = context.registry();
  const std::string folder = fs::absolute(scratch).string();
  auto [checked, report] = check_pipeline(pipeline, registry, folder, settings);
  if (!report.ok()) return std::nullopt;  // the run that follows reports the errors
  Silent observer;
  const auto summary =
      run_pipeline(checked, folder, observer, watch_for_interruption(), {.registry = &registry});
  std::error_code left;
  fs::remove_all(folder, left);
  if (!summary || summary->cancelled) return std::nullopt;
  const FocalMeasurement measured{figure(*summary, "focal_by_side"),
                                  figure(*summary, "focal_by_side_std"),
                                  static_cast<int>(figure(*summary, "frames"))};
  const bool is_certain =
      measured.frames > 0 && measured.by_side_sd < kMostUncertain * measured.by_side;
  return is_certain ? std::optional(measured) : std::nullopt;
}

}  // namespace weft::cli
