// SPDX-License-Identifier: Apache-2.0
#include "common/truth_files.hpp"

#include <set>
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
  return Error{Errc::invalid_data, path + ": belongs to no frame: none has the stem " + tried +
                                       "; rename it to STEM or STEM_KIND, or narrow 'truth'"};
}

}  // namespace

Result<void> TruthFiles::open(const std::string& pattern, const std::vector<std::string>& stems) {
  file_of_.clear();
  archive_.reset();
  if (pattern.empty()) return {};
  const std::set<std::string> frames(stems.begin(), stems.end());
  auto paths = matching_files(pattern);
  if (!paths) return Error{paths.error().code, "truth: " + paths.error().message};
  for (const std::string& path : *paths) {
    auto found = stem_of_frame(path, frames);
    if (!found) return found.error();
    const std::string name = stem_of(path), stem = *std::move(found);
    File file{path, name.size() > stem.size() ? name.substr(stem.size() + 1) : "", {}};
    if (!path.ends_with(".npz")) {
      auto truth = read_truth_file(path);
      if (!truth) return truth.error();
      file.truth = *std::move(truth);
    }
    const auto [twin, is_new] = file_of_.emplace(stem, std::move(file));
    if (is_new) continue;
    return Error{Errc::invalid_data, path + ": belongs to the frame '" + stem +
                                         "', which already has " + twin->second.path +
                                         ": remove one"};
  }
  return {};
}

Result<std::optional<GroundTruth>> TruthFiles::read(const std::string& stem) {
  const auto found = file_of_.find(stem);
  if (found == file_of_.end()) return std::optional<GroundTruth>();
  const File& file = found->second;
  std::optional<GroundTruth> truth = file.truth;
  if (!truth) {
    auto archive = TruthArchive::read(file.path);
    if (!archive) return archive.error();
    archive_.emplace(*std::move(archive));
    auto read = archive_->truth();
    if (!read) return read.error();
    truth = *std::move(read);
  }
  if (!file.kind.empty()) truth->kind = file.kind;
  return truth;
}

}  // namespace weft::sources
