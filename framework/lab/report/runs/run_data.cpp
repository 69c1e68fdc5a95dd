// SPDX-License-Identifier: Apache-2.0
#include "lab/report/runs/run_data.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "lab/metrics/metrics.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "lab/report/runs/video_pictures.hpp"
#include "lab/report/text/page.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kMostWorst = 6;

/// The value of a member as T, or `other` if it is missing or has another type.
template <class T>
T member(const json& object, const char* name, T other) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  if (!object.is_object() || found == object.end()) return other;
  if constexpr (std::is_same_v<T, std::string>) {
    return found->is_string() ? found->template get<std::string>() : other;
  } else {
    return found->is_number() ? found->template get<T>() : other;
  }
}

RunFrame frame_of(const json& line) {
  RunFrame frame;
  frame.frame = member<std::uint64_t>(line, "frame", 0);
  frame.state = member<std::string>(line, "state", "none");
  frame.reason = member<std::string>(line, "reason", "");
  frame.confidence = member(line, "confidence", kUnknown);
  for (const json& stage : line.value("stages", json::array())) {
    frame.stages.push_back(
        {member<std::string>(stage, "stage", ""), member<std::string>(stage, "status", ""),
         member<std::string>(stage, "reason", ""), member(stage, "ms", kUnknown)});
  }
  for (const json& warning : line.value("warnings", json::array())) {
    if (warning.is_string()) frame.warnings.push_back(warning.get<std::string>());
  }
  return frame;
}

/// The lines are whole: the evaluation has read them before.
std::vector<RunFrame> read_frames(const std::string& folder, const RunMetrics& metrics) {
  std::map<std::uint64_t, RunFrame> frames;
  std::istringstream lines(text_of_file(folder + "/frames.jsonl"));
  for (std::string text; std::getline(lines, text);) {
    const json line = json::parse(text, nullptr, false);
    if (!line.is_object()) continue;  // cut off at the end of the file
    RunFrame frame = frame_of(line);
    frames[frame.frame] = std::move(frame);
  }
  for (const FrameMetrics& measured : metrics.frames) {
    const auto found = frames.find(measured.frame);
    if (found != frames.end() && measured.registration) {
      found->second.within_1mm_percent = measured.registration->within_1mm_percent;
      found->second.displaced_mm = measured.registration->median_mm;
    }
    if (found == frames.end() || !measured.error) continue;
    found->second.mean_mm = measured.error->mean_mm;
    found->second.worst_mm = measured.error->worst_mm;
  }
  std::vector<RunFrame> list;
  for (auto& [number, frame] : frames) list.push_back(std::move(frame));
  return list;
}

/// The worst first: those with the largest errors, without truth those with the least confidence.
std::vector<std::uint64_t> worst_frames(const std::vector<RunFrame>& frames) {
  const bool has_error = std::any_of(frames.begin(), frames.end(), [](const RunFrame& frame) {
    return std::isfinite(frame.mean_mm);
  });
  std::vector<std::pair<double, std::uint64_t>> ranked;
  for (const RunFrame& frame : frames) {
    const double badness = has_error ? frame.mean_mm : -frame.confidence;
    if (std::isfinite(badness)) ranked.emplace_back(-badness, frame.frame);
  }
  std::stable_sort(ranked.begin(), ranked.end());
  if (ranked.size() > kMostWorst) ranked.resize(kMostWorst);
  std::vector<std::uint64_t> worst;
  for (const auto& [badness, frame] : ranked) worst.push_back(frame);
  return worst;
}

/// Frames spread evenly, and the worst.
Result<CellView> read_view(const RunReader& run, const std::vector<std::uint64_t>& worst) {
  const std::size_t step = std::max<std::size_t>(
      1, (run.lines().size() + ViewLimits{}.frames - 1) / ViewLimits{}.frames);
  std::vector<FrameRecords> owners;
  std::map<std::uint64_t, FrameShapes> frames;
  for (std::size_t i = 0; i < run.lines().size(); ++i) {
    const FrameLine& line = run.lines()[i];
    const bool bad = std::count(worst.begin(), worst.end(), line.frame) > 0;
    if (i % step != 0 && !bad) continue;
    auto records = run.read(line);
    if (!records) return records.error();
    frames[line.frame] = {std::move(records->shape), std::move(records->ground_truth)};
    owners.push_back(*std::move(records));
  }
  ViewLimits all;
  all.frames = frames.size() + 1;
  return view_of(run.sheet(), frames, all);
}

/// Uses the first AVI file of the folder that has as many images as there are frames.
void add_pictures(RunData& data) {
  std::set<std::uint64_t> wanted;
  std::map<std::uint64_t, std::uint64_t> number_of;
  for (std::size_t i = 0; i < data.frames.size(); ++i) number_of[data.frames[i].frame] = i;
  for (const WorstFrame& frame : data.worst) wanted.insert(number_of[frame.frame]);
  std::vector<std::string> files;
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(data.folder, code)) {
    if (entry.path().extension() == ".avi") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    VideoPictures pictures = video_pictures(file, wanted);
    if (pictures.count != data.frames.size()) continue;
    for (WorstFrame& frame : data.worst) {
      frame.jpeg = std::move(pictures.wanted[number_of[frame.frame]]);
    }
    return;
  }
}

void add_provenance(RunData& data) {
  const json manifest = json::parse(text_of_file(data.folder + "/manifest.json"), nullptr, false);
  data.version = member<std::string>(manifest, "weft", "?");
  data.git = member<std::string>(manifest, "git", "");
  data.pipeline = member<std::string>(manifest, "pipeline", "");
  if (manifest.is_object() && manifest.contains("machine")) {
    data.processor = member<std::string>(manifest["machine"], "processor", "");
  }
  data.settings = text_of_file(data.folder + "/pipeline.yaml");
}

}  // namespace

std::string first_frames(const std::vector<std::uint64_t>& frames) {
  constexpr std::size_t kMost = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(kMost, frames.size()); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(frames[i]);
  }
  return frames.size() > kMost ? text + ", ..." : text;
}

Result<RunData> read_run_data(const std::string& folder, const std::string& unwarping_sink) {
  auto metrics = evaluate_run(folder);
  if (!metrics) return metrics.error();
  const auto run = RunReader::open(folder);
  if (!run) return run.error();
  RunData data;
  data.folder = folder;
  data.metrics = *std::move(metrics);
  data.frames = read_frames(folder, data.metrics);
  const std::vector<std::uint64_t> worst = worst_frames(data.frames);
  auto view = read_view(*run, worst);
  if (!view) return view.error();
  data.view = *std::move(view);
  for (const std::uint64_t frame : worst) data.worst.push_back({frame, ""});
  auto print = read_flat_print(*run, data.metrics, unwarping_sink);
  if (!print) return print.error();
  data.print = *std::move(print);
  add_pictures(data);
  add_provenance(data);
  return data;
}

}  // namespace weft::lab
