// SPDX-License-Identifier: Apache-2.0
#include "common/truth_files.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <utility>
#include <weft/core/quote.hpp>

#include "common/frame_files.hpp"
#include "common/truth_file.hpp"

namespace weft::sources {
namespace {

/// The stems that a file of this name may belong to: the name, and what precedes each underscore;
/// the longest first.
std::vector<std::string> stems_in(const std::string& name) {
  std::vector<std::string> stems{name};
  for (std::size_t end = name.rfind('_'); end != name.npos && end > 0;
       end = name.rfind('_', end - 1)) {
    stems.push_back(name.substr(0, end));
  }
  return stems;
}

Result<std::string> stem_of_frame(const std::string& path, const std::set<std::string>& frames) {
  std::string tried;
  for (std::string& stem : stems_in(stem_of(path))) {
    if (frames.count(stem) > 0) return std::move(stem);
    tried += (tried.empty() ? "" : " or ") + quote(stem);
  }
  return Error{Errc::invalid_data,
               path + ": belongs to no frame: none has the stem " + tried +
                   "; rename it to STEM or STEM_KIND, narrow 'truth', or remove the file "
                   "if its writer was stopped before the image"};
}

}  // namespace

void TruthFiles::declare(Params& p) {
  p.text("truth_parts", part_words_,
         "parts that are scored separately, separated by blanks; a file's part is its folder or "
         "the end of its name: visible/STEM.ply or STEM_visible.ply");
  p.read("truth_unit_m", unit_m_, "m", {1e-9, 1e3},
         "length of one unit of true clouds in PLY and npz files");
}

Result<void> TruthFiles::open(const std::string& pattern, const std::vector<std::string>& stems) {
  files_of_.clear();
  archives_.clear();
  parts_.clear();
  std::istringstream words(part_words_);
  for (std::string word; words >> word;) parts_.push_back(word);
  if (pattern.empty()) return check_parts();
  const std::set<std::string> frames(stems.begin(), stems.end());
  auto paths = matching_files(pattern);
  if (!paths) return Error{paths.error().code, "truth: " + paths.error().message};
  for (const std::string& path : *paths) {
    auto found = stem_of_frame(path, frames);
    if (!found) return found.error();
    const std::string name = stem_of(path), stem = *std::move(found);
    auto file = classify(path, name.size() > stem.size() ? name.substr(stem.size() + 1) : "");
    if (!file) return file.error();
    if (auto taken = take(*std::move(file), stem); !taken) return taken;
  }
  return check_parts();
}

Result<TruthFiles::File> TruthFiles::classify(const std::string& path,
                                              const std::string& rest) const {
  File file{path, rest};
  const std::filesystem::path name(path);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const bool ends = rest == parts_[i] || rest.ends_with("_" + parts_[i]);
    if (!ends && name.parent_path().filename() != parts_[i]) continue;
    file.part = static_cast<std::int32_t>(i);
    if (ends) file.kind.resize(rest.size() - std::min(rest.size(), parts_[i].size() + 1));
    break;
  }
  const std::string extension = name.extension().string();
  if (extension == ".npz") return file;
  if (extension == ".ply") {
    file.form = Form::ply;
    return file;
  }
  if (extension != ".csv") {
    return Error{Errc::unsupported, path + ": the extension " + quote(extension) +
                                        " is unknown: truth is read from .csv, .npz and .ply; "
                                        "convert the file, or narrow 'truth'"};
  }
  const auto is_cloud = is_csv_cloud(path);
  if (!is_cloud) return is_cloud.error();
  file.form = *is_cloud ? Form::csv_cloud : Form::points;
  if (*is_cloud) return file;
  auto points = read_truth_file(path);
  if (!points) return points.error();
  file.points = *std::move(points);
  return file;
}

Result<void> TruthFiles::take(File file, const std::string& stem) {
  std::vector<File>& files = files_of_[stem];
  for (const File& other : files) {
    const auto refuse = [&](const std::string& sentence) {
      return Error{Errc::invalid_data, file.path + ": belongs to the frame '" + stem +
                                           "', which already has " + other.path + sentence};
    };
    if (other.part == file.part) {
      return refuse(": remove one, or distinguish them as parts by 'truth_parts'");
    }
    if (!other.kind.empty() && !file.kind.empty() && other.kind != file.kind) {
      return refuse(" of another kind, '" + other.kind + "' instead of '" + file.kind +
                    "': give the files of a frame one kind, or name what differs in 'truth_parts'");
    }
  }
  files.push_back(std::move(file));
  return {};
}

Result<void> TruthFiles::check_parts() const {
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const auto has_part = [&](const auto& frame) {
      return std::any_of(frame.second.begin(), frame.second.end(), [&](const File& file) {
        return file.part == static_cast<std::int32_t>(i);
      });
    };
    if (std::any_of(files_of_.begin(), files_of_.end(), has_part)) continue;
    return Error{Errc::not_found, "no truth file has the part '" + parts_[i] +
                                      "': its name must end in _" + parts_[i] +
                                      ", or its folder be " + parts_[i] +
                                      "; correct 'truth_parts' or 'truth'"};
  }
  return {};
}

Result<std::optional<GroundTruth>> TruthFiles::read(const std::string& stem) {
  archives_.clear();
  const auto found = files_of_.find(stem);
  if (found == files_of_.end()) return std::optional<GroundTruth>();
  TruthGathering gathering;
  std::string kind;
  for (const File& file : found->second) {
    if (kind.empty()) kind = file.kind;
    if (auto added = add(file, gathering); !added) return added.error();
  }
  std::optional<GroundTruth> truth = std::move(gathering).truth(parts_);
  if (!kind.empty()) truth->kind = kind;
  return truth;
}

Result<void> TruthFiles::add(const File& file, TruthGathering& gathering) {
  if (file.points) return gathering.add_points(*file.points, file.part, file.path);
  Result<std::optional<Cloud>> cloud = std::optional<Cloud>();
  if (file.form == Form::npz) {
    cloud = read_npz_cloud(file.path, unit_m_);
  } else {
    auto read =
        file.form == Form::ply ? read_ply_cloud(file.path, unit_m_) : read_csv_cloud(file.path);
    if (!read) return read.error();
    cloud = std::optional<Cloud>(*std::move(read));
  }
  if (!cloud) return cloud.error();
  if (*cloud) {
    gathering.add_cloud(**cloud, file.part);
    return {};
  }
  auto archive = TruthArchive::read(file.path);
  if (!archive) return archive.error();
  archives_.push_back(*std::move(archive));
  auto truth = archives_.back().truth();
  if (!truth) return truth.error();
  return gathering.add_points(*std::move(truth), file.part, file.path);
}

}  // namespace weft::sources
