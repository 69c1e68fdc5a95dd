// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/trace.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>
#include <weft/core/whole_file.hpp>

namespace weft {
namespace {

using host::Timing;
using nlohmann::ordered_json;

/// Whole nanoseconds, so that no rounding moves a call out of its parent.
std::chrono::nanoseconds length_of(const Timing& call) {
  constexpr double kLongest_ms = 1e12;
  const bool legal =
      call.took.ms >= 0.0 && call.took.ms < kLongest_ms;  // a worker may report any number
  return std::chrono::nanoseconds(legal ? std::llround(call.took.ms * 1e6) : 0);
}

double to_us(std::chrono::nanoseconds time) { return static_cast<double>(time.count()) / 1000.0; }

const char* name_of(weft_status status) {
  constexpr const char* kNames[] = {"ok", "degenerate", "no_result", "error", "cancelled", "end"};
  return kNames[static_cast<int>(status)];
}

std::string text_of(const ordered_json& event) {
  return event.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json slice(const std::string& name, const char* category, double ts_us, double dur_us,
                   int track) {
  return {{"name", name},  {"cat", category}, {"ph", "X"},   {"ts", ts_us},
          {"dur", dur_us}, {"pid", track},    {"tid", track}};
}

std::string label(const char* kind, const std::string& name, int track) {
  return text_of(
      {{"name", kind}, {"ph", "M"}, {"pid", track}, {"tid", track}, {"args", {{"name", name}}}});
}

/// Sorts by start; of calls that start together the longer one, which made the other, comes first.
void sort(host::Timings& calls) {
  std::reverse(calls.begin(), calls.end());
  std::stable_sort(calls.begin(), calls.end(), [](const Timing& a, const Timing& b) {
    return a.start != b.start ? a.start < b.start : length_of(a) > length_of(b);
  });
}

}  // namespace

Result<Trace> Trace::create(const std::string& file) {
  Trace trace(file);
  trace.stream_.open(file, std::ios::binary | std::ios::trunc);
  trace.stream_ << "[";
  if (auto written = trace.flush(); !written) return written.error();
  return trace;
}

Result<void> Trace::add(host::Timings calls) {
  add_calls(std::move(calls));
  return flush();
}

Result<void> Trace::add(const FrameResult& frame) {
  Time begin = Time::max(), end = Time::min();
  for (const Timing& call : frame.timings) {
    if (!call.worker.empty()) continue;
    begin = std::min(begin, call.start);
    end = std::max(end, call.start + length_of(call));
  }
  if (begin < end) {
    if (tracks_.empty()) origin_ = begin;
    ordered_json event =
        slice("frame", "frame", since_origin_us(begin), to_us(end - begin), track_of({}));
    event["args"] = {
        {"frame", frame.index}, {"stem", frame.stem}, {"state", to_string(frame.state)}};
    put(text_of(event));
  }
  add_calls(frame.timings);
  return flush();
}

Result<void> Trace::close() {
  stream_ << "\n]\n";
  stream_.close();
  return flush();
}

double Trace::since_origin_us(Time time) const { return to_us(time - origin_); }

int Trace::track_of(const std::string& worker) {
  const auto [entry, is_new] = tracks_.emplace(worker, static_cast<int>(tracks_.size()) + 1);
  if (is_new) {
    put(label("process_name", worker.empty() ? "weft" : "worker of " + worker, entry->second));
    put(label("thread_name", worker.empty() ? "lane" : worker, entry->second));
  }
  return entry->second;
}

void Trace::add_calls(host::Timings calls) {
  sort(calls);
  for (const Timing& call : calls) {
    if (tracks_.empty()) origin_ = call.start;
    ordered_json event = slice(call.component, "call", since_origin_us(call.start),
                               to_us(length_of(call)), track_of(call.worker));
    if (call.frame != host::kOfflineFrame) event["args"]["frame"] = call.frame;
    event["args"]["status"] = name_of(call.status);
    event["args"]["method"] = call.method;
    if (call.downloaded_bytes > 0) event["args"]["downloaded_bytes"] = call.downloaded_bytes;
    put(text_of(event));
  }
}

void Trace::put(const std::string& event) {
  stream_ << (is_empty_ ? "\n" : ",\n") << event;
  is_empty_ = false;
}

Result<void> Trace::flush() {
  errno = 0;
  if (stream_.is_open()) stream_.flush();
  if (stream_) return {};
  const std::error_code code(errno, std::generic_category());
  return Error{Errc::io,
               "cannot be written (" + (code ? why_not_written(code) : "is the disk full?") + ")",
               file_};
}

}  // namespace weft
