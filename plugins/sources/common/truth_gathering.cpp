// SPDX-License-Identifier: Apache-2.0
#include "common/truth_gathering.hpp"

#include <algorithm>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::sources {
namespace {

/// True if a ground truth has more than the places of its points.
bool is_record(const GroundTruth& truth) {
  return truth.faces.present() || truth.visible.present() || truth.depth_m.present() ||
         truth.uv_m.present() || truth.match_xy_px.present() || truth.match_label.present() ||
         truth.cloud_m.present() || truth.part_names.present();
}

template <class T>
Array<T> array_of(const std::vector<T>& values) {
  Array<T> array({static_cast<std::int64_t>(values.size())});
  std::copy(values.begin(), values.end(), array.data());
  return array;
}

GroundTruth joined(const std::vector<GroundTruth>& several) {
  std::int64_t count = 0;
  for (const GroundTruth& each : several) count += each.count();
  GroundTruth all;
  all.template_xy_m = Array<double>({count, 2});
  all.points_m = Array<double>({count, 3});
  std::int64_t at = 0;
  for (const GroundTruth& each : several) {
    if (all.kind.empty()) all.kind = each.kind;
    for (std::int64_t i = 0; i < each.count(); ++i, ++at) {
      std::copy_n(each.template_xy_m.row(i), 2, all.template_xy_m.row(at));
      std::copy_n(each.points_m.row(i), 3, all.points_m.row(at));
    }
  }
  return all;
}

}  // namespace

Result<void> TruthGathering::add_points(GroundTruth truth, std::int32_t part,
                                        const std::string& path) {
  const bool alone = is_record(truth) || (points_.size() == 1 && is_record(points_.front()));
  if (alone && !points_.empty()) {
    return Error{Errc::invalid_data,
                 path + ": cannot be joined with " + first_path_ +
                     ", since a record of truth holds more than points: give the points of all "
                     "parts as CSV files, or one of the two as a cloud"};
  }
  if (points_.empty()) first_path_ = path;
  part_of_points_.insert(part_of_points_.end(), to_index(truth.count()), part);
  points_.push_back(std::move(truth));
  return {};
}

void TruthGathering::add_cloud(const Cloud& cloud, std::int32_t part) {
  const auto first = static_cast<std::int32_t>(cloud_m_.size());
  cloud_m_.insert(cloud_m_.end(), cloud.points_m.begin(), cloud.points_m.end());
  part_of_cloud_.insert(part_of_cloud_.end(), cloud.points_m.size(), part);
  for (const auto& [a, b, c] : cloud.faces) {
    cloud_faces_.push_back({first + a, first + b, first + c});
  }
}

GroundTruth TruthGathering::truth(const std::vector<std::string>& parts) && {
  GroundTruth truth = points_.size() == 1 ? std::move(points_.front()) : joined(points_);
  if (!cloud_m_.empty()) {
    truth.cloud_m = Array<double>({static_cast<std::int64_t>(cloud_m_.size()), 3});
    for (std::size_t i = 0; i < cloud_m_.size(); ++i) {
      std::copy_n(cloud_m_[i].data(), 3, truth.cloud_m.row(static_cast<std::int64_t>(i)));
    }
    if (truth.kind.empty() && points_.empty()) truth.kind = "cloud";
  }
  if (!cloud_faces_.empty()) {
    truth.cloud_faces = Array<std::int32_t>({static_cast<std::int64_t>(cloud_faces_.size()), 3});
    for (std::size_t f = 0; f < cloud_faces_.size(); ++f) {
      std::copy_n(cloud_faces_[f].data(), 3, truth.cloud_faces.row(static_cast<std::int64_t>(f)));
    }
  }
  if (parts.empty()) return truth;
  std::string lines;
  for (const std::string& part : parts) lines += (lines.empty() ? "" : "\n") + part;
  truth.part_names = array_of(std::vector<std::uint8_t>(lines.begin(), lines.end()));
  truth.point_part = array_of(part_of_points_);
  if (!cloud_m_.empty()) truth.cloud_part = array_of(part_of_cloud_);
  return truth;
}

}  // namespace weft::sources
