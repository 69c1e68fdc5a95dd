// SPDX-License-Identifier: Apache-2.0
#include "cell_line.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <string_view>
#include <weft/core/statistics.hpp>
#include <weft/core/version.hpp>
#include <weft/evaluation/metrics_report.hpp>
#include <weft/host/content_hash.hpp>
#include <weft/host/processor.hpp>

namespace weft::evaluation {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// Text of any bytes as JSON: what is no UTF-8 is replaced.
std::string dump(const ordered_json& value) {
  return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json metrics_json(const CellResult& result, bool with_frames) {
  if (!result.metrics) return nullptr;
  ordered_json metrics = ordered_json::parse(to_json(*result.metrics));
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

constexpr std::string_view kCheckStart = ",\"check\":\"";
constexpr std::string_view kCheckEnd = "\"}";
constexpr std::size_t kCheckSize = kCheckStart.size() + kKeyDigits + kCheckEnd.size();

/// A line with the check of its text as the last member.
std::string with_check(std::string line) {
  const std::string check = host::content_hash(line);
  line.pop_back();
  return line.append(kCheckStart).append(check).append(kCheckEnd);
}

enum class Check { none, right, wrong };

Check check_of(std::string_view line) {
  if (line.size() <= kCheckSize) return Check::none;
  const std::string_view end = line.substr(line.size() - kCheckSize);
  if (!end.starts_with(kCheckStart) || !end.ends_with(kCheckEnd)) return Check::none;
  const std::string text = std::string(line.substr(0, line.size() - kCheckSize)) + "}";
  const bool right = host::content_hash(text) == end.substr(kCheckStart.size(), kKeyDigits);
  return right ? Check::right : Check::wrong;
}

}  // namespace

bool is_key(const std::string& text) {
  return text.size() == kKeyDigits &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::string cell_line(const Cell& cell, const CellResult& result, bool timed,
                      const Measurement& measurement, const std::vector<CellFile>& files) {
  ordered_json stages = ordered_json::array();
  for (std::size_t i = 0; i < cell.stages.size(); ++i) {
    stages.push_back({{"stage", cell.stages[i]}, {"key", cell.identity.stages[i]}});
  }
  utsname system{};
  uname(&system);
  return with_check(dump({{"schema", kLineSchema},
                          {"key", cell.identity.key},
                          {"rebuilt_key", cell.identity.rebuilt_key},
                          {"outcome", result.failure.empty() ? "done" : "failed"},
                          {"reason", result.failure},
                          {"metrics", metrics_json(result, measurement.frames)},
                          {"stages", std::move(stages)},
                          {"timing", timing_json(result, timed)},
                          {"machine",
                           {{"processor", host::processor_name()},
                            {"system", system.release},
                            {"executed", result.executed}}},
                          {"files", files_json(files)}}));
}

std::string withdrawal_line(const std::string& file, int number, const std::string& reason) {
  return with_check(
      dump({{"schema", kWithdrawalSchema}, {"file", file}, {"line", number}, {"reason", reason}}));
}

Result<TrustedLine> trusted_line(const std::string& text, bool with_frames) {
  const auto keep = [&](int depth, json::parse_event_t event, json& parsed) {
    return with_frames || !(depth == 2 && event == json::parse_event_t::key && parsed == "frames");
  };
  const Check check = check_of(text);
  TrustedLine line{json::parse(text, keep, false), check == Check::right};
  const auto damaged = [](const std::string& what) { return Error{Errc::invalid_data, what, {}}; };
  if (check == Check::wrong) return damaged("it was changed after it was written");
  if (!line.object.is_object()) return damaged("it is not a JSON object");
  const json schema = line.object.value("schema", json());
  const bool of_cell = schema == kLineSchema || schema == kUncheckedLineSchema;
  if (!of_cell && schema != kWithdrawalSchema) {
    return Error{Errc::incompatible,
                 "the schema is " + schema.dump() + ", this program reads '" + kLineSchema + "'",
                 {}};
  }
  if (schema != kUncheckedLineSchema && !line.checked) return damaged("its check is missing");
  const json key = line.object.value("key", json());
  if (of_cell && !(key.is_string() && is_key(key.get<std::string>()))) {
    return damaged("its key is not made of 32 hexadecimal digits");
  }
  return line;
}

std::string too_many_failed(std::int64_t failed, std::int64_t frames, int max_failed) {
  return std::to_string(failed) + " of " + std::to_string(frames) +
         " frames had an error, more than max_failed (" + std::to_string(max_failed) + ")";
}

std::string failure_of(const json& line) {
  if (line.at("outcome") != "done") {
    const std::string reason = line.value("reason", std::string());
    return reason.empty() ? "no reason was given" : reason;
  }
  // Lines without a check were written when a cell had to fail in every frame; those with another
  // max_failed than 0 have another key by now.
  if (line.at("schema") != kUncheckedLineSchema) return {};
  const std::int64_t failed = line.value("/metrics/counts/failed"_json_pointer, std::int64_t{0});
  if (failed == 0) return {};
  return too_many_failed(failed, line.at("metrics").at("counts").at("frames"), 0);
}

std::vector<CellFile> files_of_line(const json& line) {
  std::vector<CellFile> files;
  for (const json& file : line.value("files", json::array())) {
    files.push_back({file.at("name"), file.at("bytes"), file.at("hash")});
  }
  return files;
}

}  // namespace weft::evaluation
