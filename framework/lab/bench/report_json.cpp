// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>
#include <weft/core/version.hpp>

#include "lab/bench/report.hpp"

namespace weft::bench {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json json_of(const Spread& spread) {
  return {{"n", spread.n},
          {"median", number(spread.median)},
          {"p95", number(spread.p95)},
          {"p99", number(spread.p99)}};
}

ordered_json json_of(const std::optional<Spread>& spread) {
  return spread ? json_of(*spread) : ordered_json(nullptr);
}

ordered_json json_of(const Ratio& ratio) {
  return {{"ratio", number(ratio.ratio)},
          {"low", number(ratio.interval.low)},
          {"high", number(ratio.interval.high)},
          {"pairs", ratio.pairs},
          {"turns", ratio.turns}};
}

ordered_json json_of(const MachineSpeed& speed) {
  return {{"copy_l1_bytes_per_s", number(speed.l1_bytes_per_s)},
          {"copy_l2_bytes_per_s", number(speed.l2_bytes_per_s)},
          {"copy_memory_bytes_per_s", number(speed.memory_bytes_per_s)},
          {"multiply_adds_per_s", number(speed.multiply_adds_per_s)}};
}

ordered_json json_of(const Row& row) {
  ordered_json object{
      {"part", row.part},
      {"component", row.component.empty() ? ordered_json(nullptr) : ordered_json(row.component)},
      {"statuses", row.statuses},
      {"wall_ms", json_of(row.ms)},
      {"processor_ms", json_of(row.processor_ms)},
      {"allocated_blocks", json_of(row.blocks)},
      {"allocated_bytes", json_of(row.bytes)}};
  object["read_bytes"] = row.moved ? ordered_json(row.moved->in) : ordered_json(nullptr);
  object["made_bytes"] = row.moved ? ordered_json(row.moved->out) : ordered_json(nullptr);
  object["floor_ms"] = number(row.floor_ms);
  object["times_floor"] = number(times_floor(row));
  return object;
}

ordered_json memory_of(const std::optional<Counts>& counts) {
  if (!counts) return nullptr;
  return {{"loaded_kib", counts->loaded_kib},
          {"peak_kib", counts->peak_kib},
          {"above_loaded_kib", counts->peak_kib - counts->loaded_kib}};
}

ordered_json overlap_of(const std::optional<OverlapFigures>& overlap) {
  if (!overlap) return nullptr;
  return {{"frames_at_once", overlap->frames_at_once},
          {"threads", overlap->threads},
          {"frames_per_s", json_of(overlap->frames_per_s_spread)},
          {"frames_per_s_each", overlap->frames_per_s},
          {"latency_ms", json_of(overlap->latency_ms)},
          {"cores", number(overlap->cores)}};
}

/// The whole frames one by one, for other statistics.
ordered_json samples_of(const PipelineReport& pipeline) {
  ordered_json all = ordered_json::array();
  for (const Part& part : pipeline.parts) {
    if (part.name != kFrame) continue;
    for (const PartSample& sample : part.samples) {
      all.push_back({{"turn", sample.turn},
                     {"repetition", sample.repetition},
                     {"frame", sample.frame},
                     {"wall_ms", number(sample.took.ms)},
                     {"processor_ms", number(sample.took.processor_ms)}});
    }
  }
  return all;
}

ordered_json json_of(const PipelineReport& pipeline) {
  ordered_json parts = ordered_json::array();
  for (const Row& row : pipeline.rows) parts.push_back(json_of(row));
  return {{"name", pipeline.entry.name},
          {"file", pipeline.entry.file},
          {"settings", pipeline.entry.settings},
          {"states", pipeline.states},
          {"parts", parts},
          {"overlap", overlap_of(pipeline.overlap)},
          {"memory", memory_of(pipeline.counts)},
          {"why_no_counts", pipeline.why_no_counts.empty() ? ordered_json(nullptr)
                                                           : ordered_json(pipeline.why_no_counts)},
          {"frames", samples_of(pipeline)}};
}

}  // namespace

std::string json_of(const Report& report) {
  const Settings& settings = report.settings;
  ordered_json all{{"schema", "weft-bench/1"},
                   {"weft", kVersion},
                   {"command", report.command},
                   {"settings",
                    {{"frames", settings.frames},
                     {"warmup", settings.warmup},
                     {"repetitions", settings.repetitions},
                     {"block", settings.block}}},
                   {"machine", json_of(report.speed)}};
  all["machine"]["processor"] = report.processor;
  all["baseline"] = report.baseline.empty() ? ordered_json(nullptr) : ordered_json(report.baseline);
  all["pipelines"] = ordered_json::array();
  for (const PipelineReport& each : report.pipelines) all["pipelines"].push_back(json_of(each));
  all["ratios"] = ordered_json::array();
  for (const RatioReport& each : report.ratios) {
    all["ratios"].push_back({{"of", each.of},
                             {"over", each.over},
                             {"part", each.part},
                             {"wall", json_of(each.wall)},
                             {"processor", json_of(each.processor)}});
  }
  return all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace weft::bench
