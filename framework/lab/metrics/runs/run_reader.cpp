// SPDX-License-Identifier: Apache-2.0
#include "lab/metrics/runs/run_reader.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <weft/core/text_file.hpp>
#include <weft/data/matrix.hpp>

#include "lab/metrics/runs/run_damage.hpp"
#include "pipeline/execution/match_depths.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

std::string frame_file(const std::string& folder, std::uint64_t frame) {
  std::string digits = std::to_string(frame);
  digits.insert(0, digits.size() < 6 ? 6 - digits.size() : 0, '0');
  return folder + "/frames/" + digits + ".npz";
}

/// The struct of a slot's record, borrowing from it; nothing where the slot is absent.
template <class RecordType>
Result<std::optional<RecordType>> find_typed(const host::NamedRecords& records,
                                             const std::string& slot, const std::string& file) {
  for (const auto& [name, record] : records) {
    if (name != slot) continue;
    if (record->type() != RecordType::kType) {
      return Error{Errc::incompatible,
                   slot + " is a " + std::string(record->type()) + " instead of a " +
                       RecordType::kType + "; evaluate with the version of Weft that wrote the run",
                   file};
    }
    auto typed = host::view_as<RecordType>(*record);
    if (!typed) return Error{typed.error().code, typed.error().message, file};
    return std::optional<RecordType>(*std::move(typed));
  }
  return std::optional<RecordType>();
}

/// True if matches have finite numbers and faces of the mesh, as the program writes them.
bool usable(const Correspondences& matches, std::int64_t faces) {
  for (std::int64_t n = 0; n < matches.count(); ++n) {
    if (matches.face(n) < -1 || matches.face(n) >= faces) return false;
  }
  return matches.template_px.matrix<2>().allFinite() && matches.image_px.matrix<2>().allFinite() &&
         matches.barycentrics.matrix<3>().allFinite();
}

/// The matches of a frame after the filters; RunFolder documents the names of the slots.
class MatchFinder {
 public:
  MatchFinder(const host::NamedRecords& records, std::int64_t faces, const std::string& file)
      : records_(records), faces_(faces), file_(file) {}

  Result<std::vector<MatchRecords>> find() {
    for (const auto& [slot, record] : records_) {
      const std::size_t dot = slot.rfind('.');
      if (dot == std::string::npos) continue;
      const std::string path = slot.substr(0, dot), type = slot.substr(dot + 1);
      Result<void> added;
      if (type == "correspondences") added = add_matches(slot, path);
      if (type == "inlier_mask") added = add_mask(slot, path);
      if (type == "match_depths") added = add_depths(slot, path);
      if (!added) return added.error();
    }
    return std::move(found_);
  }

 private:
  struct Left {
    std::size_t index;  ///< into found_
    Array<std::uint8_t> kept;
  };

  Result<void> add_matches(const std::string& slot, const std::string& path) {
    auto matches = find_typed<Correspondences>(records_, slot, file_);
    if (!matches) return matches.error();
    if (!usable(**matches, faces_)) {
      return damaged_run(file_, "has matches in " + slot + " with NaN, infinity or no such face");
    }
    left_.insert_or_assign(path, Left{found_.size(), (*matches)->kept});
    found_.push_back({path, **std::move(matches), {}, {}});
    return {};
  }

  Result<void> add_mask(const std::string& slot, const std::string& path) {
    const std::size_t dot = path.rfind('.');
    const auto before = left_.find(path.substr(0, std::min(dot, path.size())));
    auto mask = find_typed<InlierMask>(records_, slot, file_);
    if (!mask) return mask.error();
    if (before == left_.end() || before->second.kept.rows() != (*mask)->kept.rows() ||
        (*mask)->score.rows() != (*mask)->kept.rows()) {
      return damaged_run(file_, "has in " + slot + " no entry for each match");
    }
    const Left& from = before->second;
    found_[from.index].filters.push_back(
        {path.substr(dot + 1), from.kept, (*mask)->kept, (*mask)->score});
    left_.insert_or_assign(path, Left{from.index, (*mask)->kept});
    return {};
  }

  Result<void> add_depths(const std::string& slot, const std::string& path) {
    auto depths = find_typed<MatchDepths>(records_, slot, file_);
    if (!depths) return depths.error();
    if (found_.empty() || found_.back().stage != path ||
        found_.back().matches.count() != (*depths)->depth_m.rows()) {
      return damaged_run(file_, "has in " + slot + " no entry for each match");
    }
    found_.back().depth_m = (*depths)->depth_m;
    return {};
  }

  const host::NamedRecords& records_;
  std::int64_t faces_;
  const std::string& file_;
  std::map<std::string, Left> left_;  ///< by path
  std::vector<MatchRecords> found_;
};

Result<std::vector<WarpRecords>> find_warps(const host::NamedRecords& records,
                                            std::int64_t vertices, const std::string& file) {
  constexpr std::string_view kEnd = ".warp_samples";
  std::vector<WarpRecords> warps;
  for (const auto& [slot, record] : records) {
    if (!slot.ends_with(kEnd)) continue;
    auto samples = find_typed<WarpSamples>(records, slot, file);
    if (!samples) return samples.error();
    if ((*samples)->xy_px.rows() != vertices) {
      return damaged_run(file, "has in " + slot + " no entry for each vertex");
    }
    warps.push_back({slot.substr(0, slot.size() - kEnd.size()), **std::move(samples)});
  }
  return warps;
}

}  // namespace

Result<RunReader> RunReader::open(const std::string& folder) {
  std::error_code code;
  if (auto found =
          check_input(folder, InputKind::folder, "give the folder that `weft run --out` wrote");
      !found) {
    return found.error();
  }
  for (const char* file : {"frames.jsonl", "template.npz"}) {
    if (fs::is_regular_file(folder + "/" + file, code)) continue;
    return Error{Errc::not_found,
                 std::string("is no run folder, it has no ") + file +
                     "; give the folder that `weft run --out` wrote",
                 folder};
  }
  RunReader reader(folder);
  const std::string file = folder + "/template.npz";
  auto scene = host::read_npz(file);
  if (!scene) return scene.error();
  if (auto taken = reader.take_scene(*std::move(scene), file); !taken) return taken.error();
  if (auto read = reader.read_lines(); !read) return read.error();
  if (auto read = reader.read_manifest(); !read) return read.error();
  if (auto checked = reader.check_numbers(); !checked) return checked.error();
  auto measured = read_registrations(folder);
  if (!measured) return measured.error();
  reader.measured_ = *std::move(measured);
  return reader;
}

Result<RunReader> RunReader::in_memory(const std::string& where, host::NamedRecords scene) {
  RunReader reader(where);
  if (auto taken = reader.take_scene(std::move(scene), where); !taken) return taken.error();
  return reader;
}

Result<void> RunReader::take_scene(host::NamedRecords scene, const std::string& file) {
  template_owner_ = std::move(scene);
  auto sheet = find_typed<Template>(template_owner_, "template", file);
  if (!sheet) return sheet.error();
  if (!*sheet) return damaged_run(file, "holds no template");
  template_ = **std::move(sheet);
  const auto camera = find_typed<Camera>(template_owner_, "camera", file);
  if (!camera) return camera.error();
  if (!*camera) return damaged_run(file, "holds no camera");
  camera_ = **camera;
  return {};
}

Result<FrameRecords> RunReader::read(const FrameLine& line) const {
  const std::string file = frame_file(folder_, line.frame);
  std::error_code code;
  if (fs::exists(file, code)) {
    auto records = host::read_npz(file, host::NpzCheck::none);
    if (!records) return records.error();
    if (line.records >= 0 && line.records != static_cast<std::int64_t>(records->size())) {
      return damaged_run(file, "has " + std::to_string(records->size()) +
                                   " records where frames.jsonl has " +
                                   std::to_string(line.records));
    }
    if (measured_) {
      std::erase_if(*records, [](const auto& named) { return named.first == "registration"; });
      const auto found = measured_->find(line.frame);
      if (found != measured_->end()) records->emplace_back("registration", found->second);
    }
    return sort(*std::move(records), line, file);
  }
  if (line.state != ShapeState::none || line.records > 0) return damaged_run(file, "is missing");
  return sort({}, line, file);
}

Result<FrameRecords> RunReader::sort(host::NamedRecords records, const FrameLine& line,
                                     const std::string& file) const {
  FrameRecords frame;
  frame.owners = std::move(records);
  auto shape = find_typed<Shape>(frame.owners, "shape", file);
  if (!shape) return shape.error();
  auto truth = find_typed<GroundTruth>(frame.owners, "ground_truth", file);
  if (!truth) return truth.error();
  auto visibility = find_typed<Visibility>(frame.owners, "visibility", file);
  if (!visibility) return visibility.error();
  auto registration = find_typed<Registration>(frame.owners, "registration", file);
  if (!registration) return registration.error();
  frame.visibility = *std::move(visibility);
  frame.registration = *std::move(registration);
  frame.shape = *std::move(shape);
  frame.ground_truth = *std::move(truth);
  auto matches = MatchFinder(frame.owners, template_.faces.rows(), file).find();
  if (!matches) return matches.error();
  frame.matches = *std::move(matches);
  auto warps = find_warps(frame.owners, template_.vertices_m.rows(), file);
  if (!warps) return warps.error();
  frame.warps = *std::move(warps);
  const ShapeState stored = frame.shape ? frame.shape->shape_state() : ShapeState::none;
  if (stored != line.state) {
    return damaged_run(file, std::string("has the state '") + to_string(stored) +
                                 "' where frames.jsonl has '" + to_string(line.state) + "'");
  }
  if (frame.shape && frame.shape->vertices_m.rows() != template_.vertices_m.rows()) {
    return damaged_run(file, "has " + std::to_string(frame.shape->vertices_m.rows()) +
                                 " vertices where the template has " +
                                 std::to_string(template_.vertices_m.rows()));
  }
  if (frame.visibility && frame.visibility->visible.rows() != template_.vertices_m.rows()) {
    return damaged_run(file, "has in visibility no entry for each vertex");
  }
  if (frame.ground_truth && !(frame.ground_truth->template_xy_m.matrix<2>().allFinite() &&
                              frame.ground_truth->points_m.matrix<3>().allFinite() &&
                              (!frame.ground_truth->cloud_m.present() ||
                               frame.ground_truth->cloud_m.matrix<3>().allFinite()))) {
    return damaged_run(file, "has a ground truth with NaN or infinity");
  }
  return frame;
}

}  // namespace weft::lab
