// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/run_folder.hpp"

#include <sys/utsname.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <weft/core/output_folder.hpp>
#include <weft/core/version.hpp>
#include <weft/core/whole_file.hpp>
#include <weft/data/camera.hpp>

#include "host/loading/processor.hpp"
#include "host/loading/secrets.hpp"
#include "pipeline/execution/match_depths.hpp"
#include "pipeline/runs/frame_json.hpp"
#include "pipeline/runs/source_revision.hpp"

namespace weft {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kEndFile = "end.json";  // a run that did not come to its end has none

Error io_error(const std::string& file, const std::string& message) {
  return {Errc::io, message, file};
}

Error not_on_disk(const std::string& path, std::error_code code) {
  return io_error(path, "cannot be written to disk (" + why_not_written(code) + ")");
}

void add_components(const host::ComponentSpec& spec, const std::string& stage,
                    ordered_json& components) {
  const host::Installed& installed = *spec.installed;
  components.push_back({{"stage", stage},
                        {"id", installed.component.id},
                        {"version", installed.component.version},
                        {"build_id", installed.library->build_id},
                        {"implements", installed.component.implements},
                        {"licence", installed.component.licence},
                        {"determinism", installed.component.determinism},
                        {"uses_truth", installed.component.uses_truth},
                        {"library", installed.library->library}});
  for (const auto& [parameter, child] : spec.nested) {
    add_components(child, stage + "/" + parameter, components);
  }
}

/// The files that the pipeline was made from, and the settings merged into them.
ordered_json source_names(const std::vector<ConfigSource>& sources) {
  ordered_json names = ordered_json::array();
  for (const ConfigSource& source : sources) {
    names.push_back(source.is_setting ? "--set " + host::shown_setting(source.name) : source.name);
  }
  return names;
}

ordered_json provenance(const PipelineConfig& config) {
  utsname system{};
  uname(&system);
  ordered_json components = ordered_json::array();
  add_components(config.source->component, config.source->name, components);
  add_components(config.templ->component, config.templ->name, components);
  for (const auto* stages : {&config.stages, &config.sinks}) {
    for (const StageConfig& stage : *stages) {
      add_components(stage.component, stage.name, components);
    }
  }
  ordered_json facts{
      {"weft", kVersion},        {"git", host::source_revision()},
      {"pipeline", config.file}, {"sources", source_names(config.sources)},
      {"seed", config.seed},     {"reproducible", !config.latest_only && config.budget_ms == 0}};
  if (config.latest_only) facts["realtime"] = "latest";
  if (!config.is_sequence) facts["sequence"] = false;
  facts["end"] = kEndFile;
  facts["machine"] = {{"processor", host::processor_name()}, {"system", system.release}};
  facts["components"] = std::move(components);
  return facts;
}

std::string frame_name(std::uint64_t index) {
  char name[32];
  std::snprintf(name, sizeof(name), "%06llu", static_cast<unsigned long long>(index));
  return name;
}

/// Assumptions about a camera without a calibration; null for one that was.
ordered_json assumed_camera(const host::Record& record) {
  const auto camera = host::view_as<Camera>(record);
  const auto assumed = camera ? CameraAssumption::of(*camera) : std::nullopt;
  if (!assumed) return {};
  return {{"fx_px", camera->fx},
          {"fy_px", camera->fy},
          {"focal_sd_px", rounded(assumed->focal_sd_px, 1e4)},
          {"centre_px", {camera->cx, camera->cy}},
          {"centre_sd_px", {rounded(assumed->cx_sd_px, 1e4), rounded(assumed->cy_sd_px, 1e4)}},
          {"from", assumed->from}};
}

/// Text of any bytes as JSON: replaces bytes that are not UTF-8.
std::string dump(const ordered_json& object, int indent = -1) {
  return object.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

/// Counts of the matches that a filter kept, without the matches themselves.
host::RecordPtr mask_of(const host::Record& matches) {
  auto mask = std::make_shared<host::Record>(InlierMask::kType);
  for (const char* array : {"kept", "score", "confidence"}) mask->share(matches, array);
  return mask;
}

/// The mask of a filter that gave no result for these matches: nothing is left of them.
host::RecordPtr mask_of_none(const host::Record& matches) {
  const weft_array* kept = find_array(matches.view(""), "kept");
  const std::int64_t count = kept->shape[0];
  return host::Record::copy_of(
      InlierMask{Array<std::uint8_t>({count}, 0), Array<double>({count}, 0.0), {}});
}

/// The truth without its images. One image is larger than everything else that a frame leaves.
host::RecordPtr without_images(const host::Record& truth) {
  auto kept = std::make_shared<host::Record>(truth.type());
  const weft_record view = truth.view("");
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const std::string_view name = view.arrays[i].name;
    if (name != "depth_m" && name != "uv_m") kept->share(truth, name);
  }
  return kept;
}

/// The true depth at matches, if it is known.
void add_depths(const std::string& path, const host::Record& matches, const host::RecordPtr& truth,
                host::NamedRecords& records) {
  const auto known = truth == nullptr ? Result<GroundTruth>(no_result("no truth"))
                                      : host::view_as<GroundTruth>(*truth);
  const auto typed = host::view_as<Correspondences>(matches);
  if (!known || !known->depth_m.present() || !typed) return;
  records.emplace_back(path + ".match_depths",
                       host::Record::copy_of(depths_at(*typed, known->depth_m)));
}

/// Where warps take the template's vertices, without derivatives.
void add_warps(const Graph& graph, const FrameResult& frame, host::NamedRecords& records) {
  for (std::size_t i = 0; i < frame.values.size(); ++i) {
    const ValueInfo& value = graph.values[i];
    if (value.slot != "warp_samples" || frame.values[i] == nullptr) continue;
    auto samples = std::make_shared<host::Record>(WarpSamples::kType);
    for (const char* array : {"xy_px", "valid"}) samples->share(*frame.values[i], array);
    records.emplace_back(value.name + ".warp_samples", std::move(samples));
  }
}

/// Adds the record of the last pass that makes this output.
void add_last(const std::string& slot, const Graph& graph, const FrameResult& frame,
              host::NamedRecords& records) {
  host::RecordPtr last;
  for (std::size_t i = 0; i < frame.values.size(); ++i) {
    const bool has_value = graph.values[i].slot == slot && frame.values[i] != nullptr;
    if (has_value) last = frame.values[i];
  }
  if (last != nullptr) records.emplace_back(slot, last);
}

/// All matches of a frame, each array once, and a mask of each filter that they were given to.
void add_matches(const Graph& graph, const FrameResult& frame, const host::RecordPtr& truth,
                 host::NamedRecords& records) {
  struct Made {
    std::string path;
    host::RecordPtr matches;  // before any filter
  };
  std::map<int, Made> made;  // by index of the value
  for (std::size_t i = 0; i < frame.values.size(); ++i) {
    const ValueInfo& value = graph.values[i];
    const host::RecordPtr& record = frame.values[i];
    if (value.slot != "correspondences") continue;
    const auto before = made.find(value.filtered);
    if (before != made.end()) {
      const Made from{before->second.path + "." + value.name, before->second.matches};
      records.emplace_back(from.path + ".inlier_mask",
                           record != nullptr ? mask_of(*record) : mask_of_none(*from.matches));
      made.emplace(static_cast<int>(i), from);
    } else if (record != nullptr) {
      made.emplace(static_cast<int>(i), Made{value.name, record});
      records.emplace_back(value.name + ".correspondences", record);
      add_depths(value.name, *record, truth, records);
    }
  }
}

}  // namespace

host::NamedRecords frame_records(const Graph& graph, const FrameResult& frame,
                                 const host::RecordPtr& ground_truth) {
  host::NamedRecords records;
  if (frame.shape != nullptr) records.emplace_back("shape", frame.shape);
  if (ground_truth != nullptr) records.emplace_back("ground_truth", without_images(*ground_truth));
  add_last("visibility", graph, frame, records);
  add_last("registration", graph, frame, records);
  add_matches(graph, frame, ground_truth, records);
  add_warps(graph, frame, records);
  return records;
}

Result<RunFolder> RunFolder::create(const std::string& given) {
  fs::path absolute = fs::absolute(given);
  if (!absolute.has_filename()) absolute = absolute.parent_path();  // for "runs/mine/"
  const std::string path = absolute.string();
  const Error taken =
      io_error(given, "exists and is not an empty folder; choose another with --out");
  if (!is_free_for_folder(path)) return taken;
  std::error_code code = make_folders(folder_of(path));
  const bool is_new = !code && fs::create_directory(path, code);
  if (!code) code = make_folders(path);
  // If two runs begin together, one makes this folder.
  if (!code && !fs::create_directory(path + "/frames", code) && !code) return taken;
  if (code) return io_error(given, "cannot be created: " + code.message());
  RunFolder folder(path);
  folder.is_new_ = is_new;
  folder.frames_.open(path + "/frames.jsonl");
  if (!folder.frames_) return io_error(path + "/frames.jsonl", "cannot be created");
  return folder;
}

Result<void> RunFolder::begin(const PipelineConfig& config, const host::Record& templ,
                              const host::Record& camera, std::int64_t source_frames) {
  constexpr Durability kLater = Durability::unsynced;
  const std::string file = path_ + "/pipeline.yaml";
  if (auto written = write_whole(effective_yaml(config), file, kLater); !written) return written;
  ordered_json manifest = provenance(config);
  if (source_frames >= 0) manifest["source_frames"] = source_frames;
  ordered_json assumed = assumed_camera(camera);
  if (!assumed.is_null()) manifest["assumed_camera"] = std::move(assumed);
  auto written = write_whole(dump(manifest, 2) + "\n", path_ + "/manifest.json", kLater);
  if (!written) return written;
  const auto borrow = [](const host::Record& record) {
    return host::RecordPtr(&record, [](const host::Record*) {});
  };
  written = host::write_npz(path_ + "/template.npz",
                            {{"template", borrow(templ)}, {"camera", borrow(camera)}}, kLater);
  if (!written) return written;
  for (const char* name : {"pipeline.yaml", "manifest.json", "template.npz", "."}) {
    if (const auto code = sync_path(fs::path(path_) / name)) return not_on_disk(path_, code);
  }
  return {};
}

void RunFolder::withdraw() {
  frames_.close();
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(path_, ignored)) {
    fs::remove_all(entry.path(), ignored);
  }
  if (is_new_) fs::remove(path_, ignored);
}

Result<void> RunFolder::add(const FrameResult& frame, const host::NamedRecords& records) {
  if (!records.empty()) {
    const std::string file = path_ + "/frames/" + frame_name(frame.index) + ".npz";
    if (auto written = host::write_npz(file, records, Durability::unsynced); !written)
      return written;
  }
  errno = 0;
  // At once: a line that was written has its end.
  frames_ << frame_json(frame, records.size()) + "\n" << std::flush;
  if (frames_) return {};
  return io_error(path_ + "/frames.jsonl",
                  "cannot be written (" +
                      why_not_written(std::error_code(errno, std::generic_category())) + ")");
}

Result<void> RunFolder::end(const RunSummary& summary, bool drops) const {
  ordered_json end{
      {"frames", summary.frames}, {"failed", summary.failed}, {"stopped", summary.stopped}};
  if (drops) end["dropped"] = summary.dropped;
  if (!summary.late_in.empty()) end["late_in"] = summary.late_in;
  for (const auto& [name, value] : summary.camera) end["camera"][name] = rounded(value, 1e4);
  if (const auto code = sync_file_system(path_)) return not_on_disk(path_, code);
  return write_whole(dump(end) + "\n", path_ + "/" + kEndFile);
}

}  // namespace weft
