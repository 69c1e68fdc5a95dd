// SPDX-License-Identifier: Apache-2.0
#include "lab/report/runs/flat_print.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>
#include <weft/data/matrix.hpp>

#include "lab/report/runs/png_picture.hpp"
#include "lab/report/text/page.hpp"
#include "yaml/yaml.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLongest_px = 1000;  ///< longer side of the images on the page

/// The worst, the median and the best frame by the patches within 1 mm, each frame once; or the
/// only one.
std::vector<PrintFrame> chosen_frames(const RunMetrics& metrics) {
  std::vector<std::pair<double, std::uint64_t>> ranked;
  for (const FrameMetrics& frame : metrics.frames) {
    if (!frame.registration || frame.registration->patches == 0) continue;
    ranked.emplace_back(frame.registration->within_1mm_percent, frame.frame);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<PrintFrame> frames;
  if (ranked.empty()) return frames;
  frames.push_back({ranked.size() > 1 ? "Worst" : "Only", ranked.front().second, {}, {}, {}});
  if (ranked.size() > 2) {
    frames.push_back({"Median", ranked[(ranked.size() - 1) / 2].second, {}, {}, {}});
  }
  if (ranked.size() > 1) frames.push_back({"Best", ranked.back().second, {}, {}, {}});
  return frames;
}

std::vector<PrintPatch> patches_of(const Registration& measured) {
  std::vector<PrintPatch> patches;
  for (std::int64_t i = 0; i < measured.count(); ++i) {
    PrintPatch patch{measured.place_px(i, 0), measured.place_px(i, 1)};
    if (measured.found(i) != 0) {
      patch.du_mm = measured.displacement_mm(i, 0);
      patch.dv_mm = measured.displacement_mm(i, 1);
    }
    patches.push_back(patch);
  }
  return patches;
}

/// The folder of the sink with this id, as the pipeline of the run names it; empty without one.
std::string folder_of_sink(const std::string& run, const std::string& id) {
  const auto pipeline = yaml::parse(text_of_file(run + "/pipeline.yaml"), "pipeline.yaml");
  const yaml::Node* sinks = pipeline ? pipeline->root.find("sinks") : nullptr;
  if (sinks == nullptr) return "";
  for (const yaml::Node& sink : sinks->items) {
    const yaml::Node* use = sink.find("use");
    if (use == nullptr || use->scalar != id) continue;
    const yaml::Node* params = sink.find("params");
    const yaml::Node* path = params != nullptr ? params->find("path") : nullptr;
    // Without a path it is named as the sink is.
    return (fs::path(run) / (path != nullptr ? path->scalar : id.substr(id.find('/') + 1)))
        .string();
  }
  return "";
}

void add_unwarped(const std::string& folder, PrintFrame& frame) {
  char name[40];
  std::snprintf(name, sizeof name, "/%06llu", static_cast<unsigned long long>(frame.frame));
  frame.unwarped = smaller_png(text_of_file(folder + name + ".png"), kLongest_px);
  frame.media_type = "image/png";
  if (!frame.unwarped.empty()) return;
  frame.unwarped = text_of_file(folder + name + ".jpg");
  frame.media_type = "image/jpeg";
}

}  // namespace

Result<FlatPrint> read_flat_print(const RunReader& run, const RunMetrics& metrics,
                                  const std::string& unwarping_sink) {
  FlatPrint print;
  const Template& sheet = run.sheet();
  if (!sheet.m_per_px.present() || sheet.texture.ndim() < 2) return print;
  print.frames = chosen_frames(metrics);
  if (print.frames.empty()) return print;
  print.width_px = sheet.texture.dim(1);
  print.height_px = sheet.texture.dim(0);
  print.mm_per_px_u = kMmPerM * sheet.m_per_px(0);
  print.mm_per_px_v = kMmPerM * sheet.m_per_px(1);
  print.png = png_of(sheet.texture, kLongest_px);
  const std::string folder = folder_of_sink(run.folder(), unwarping_sink);
  for (PrintFrame& frame : print.frames) {
    const auto line = std::find_if(run.lines().begin(), run.lines().end(),
                                   [&](const FrameLine& one) { return one.frame == frame.frame; });
    const auto records = run.read(*line);
    if (!records) return records.error();
    frame.patches = patches_of(*records->registration);
    if (!folder.empty()) add_unwarped(folder, frame);
  }
  return print;
}

}  // namespace weft::lab
