// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/line_of_cell.hpp"

#include <sys/utsname.h>

#include <weft/core/statistics.hpp>

#include "host/loading/processor.hpp"
#include "lab/metrics/forms/json.hpp"
#include "lab/results/cell_line.hpp"

namespace weft::lab {
namespace {

using nlohmann::ordered_json;

ordered_json metrics_json(const CellResult& result, bool with_frames) {
  if (!result.metrics) return nullptr;
  ordered_json metrics = json_of(*result.metrics);
  if (!with_frames) metrics["frames"] = ordered_json::array();
  return metrics;
}

ordered_json timing_json(const CellResult& result, bool timed) {
  if (!timed) return {{"cached", true}};
  ordered_json stages = ordered_json::array();
  for (const StageTiming& timing : result.timings) {
    if (timing.ms.empty()) continue;
    stages.push_back({{"stage", timing.stage},
                      {"frames", timing.ms.size()},
                      {"mean_ms", mean(timing.ms)},
                      {"p50_ms", percentile(timing.ms, 50.0)},
                      {"p95_ms", percentile(timing.ms, 95.0)},
                      {"mean_processor_ms", mean(timing.processor_ms)}});
  }
  const std::int64_t frames = result.metrics ? result.metrics->counts.frames : 0;
  return {{"frames", frames}, {"stages", std::move(stages)}};
}

ordered_json files_json(const std::vector<CellFile>& files) {
  ordered_json list = ordered_json::array();
  for (const CellFile& file : files) {
    list.push_back({{"name", file.name}, {"bytes", file.bytes}, {"hash", file.hash}});
  }
  return list;
}

}  // namespace

std::string line_of_cell(const Cell& cell, const CellResult& result, bool timed,
                         const Measurement& measurement, const std::vector<CellFile>& files) {
  ordered_json stages = ordered_json::array();
  for (std::size_t i = 0; i < cell.stages.size(); ++i) {
    stages.push_back({{"stage", cell.stages[i]}, {"key", cell.identity.stages[i]}});
  }
  utsname system{};
  uname(&system);
  return checked_line({{"schema", kLineSchema},
                       {"key", cell.identity.key},
                       {"rebuilt_key", cell.identity.rebuilt_key},
                       {"outcome", result.failure.empty() ? "done" : "failed"},
                       {"reason", result.failure},
                       {"first_error", result.first_error},
                       {"metrics", metrics_json(result, measurement.frames)},
                       {"stages", std::move(stages)},
                       {"timing", timing_json(result, timed)},
                       {"machine",
                        {{"processor", host::processor_name()},
                         {"system", system.release},
                         {"seconds", result.seconds},
                         {"executed", result.executed}}},
                       {"files", files_json(files)}});
}

}  // namespace weft::lab
