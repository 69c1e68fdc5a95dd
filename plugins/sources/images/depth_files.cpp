// SPDX-License-Identifier: Apache-2.0
#include "depth_files.hpp"

#include "files_by_stem.hpp"

namespace weft::images {
namespace {

Result<cv::Mat> read_depth_file(const std::string& path, const cameras::CalibratedCamera& camera) {
  auto depth = cameras::read_image_beside(path, camera);
  if (!depth) return depth;
  if (depth->type() != CV_16UC1) {
    return Error{Errc::unsupported,
                 path +
                     ": a depth image has one channel of 16 bits; convert it, 0 where nothing "
                     "was measured"};
  }
  return depth;
}

}  // namespace

void DepthFiles::declare(Params& p) {
  p.input_path("depth", pattern_,
               "depth images aligned to the frames, 16 bits, with the stems of the frames");
  p.read("depth_unit_m", unit_m_, "m", {1e-9, 1e3}, "depth of one unit of the depth images");
}

Result<void> DepthFiles::open(const std::vector<std::string>& stems) {
  auto files = files_by_stem("depth", pattern_, stems);
  if (!files) return files.error();
  path_of_ = *std::move(files);
  return {};
}

Result<void> DepthFiles::add_to(std::optional<GroundTruth>& truth, const std::string& stem,
                                const cameras::CalibratedCamera& camera) const {
  const auto found = path_of_.find(stem);
  if (found == path_of_.end()) return {};
  const auto stored = read_depth_file(found->second, camera);
  if (!stored) return stored.error();
  auto depth_m = camera.undistorted_depth(*stored, found->second, unit_m_);
  if (!depth_m) return depth_m.error();
  if (!truth) truth = GroundTruth{Array<double>({0, 2}), Array<double>({0, 3}), "depth", ""};
  truth->depth_m = *std::move(depth_m);
  return {};
}

}  // namespace weft::images
