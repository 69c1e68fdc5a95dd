// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/kept_frames.hpp"

#include <fmt/core.h>

#include <weft/data/ground_truth.hpp>
#include <weft/data/template.hpp>

namespace weft::lab {

using host::Record;
using host::RecordPtr;

RecordPtr without_texture(const Record& templ) {
  auto sheet = host::view_as<Template>(templ);
  if (!sheet) return nullptr;
  sheet->texture = Array<std::uint8_t>({1, 1}, 0);
  sheet->mask = Array<std::uint8_t>({1, 1}, 0);
  return Record::copy_of(*sheet);
}

RecordPtr thinned(const Record& ground_truth) {
  const auto whole = host::view_as<GroundTruth>(ground_truth);
  if (!whole) return nullptr;
  const std::int64_t step = (whole->count() + kMostKeptPoints - 1) / kMostKeptPoints;
  const std::int64_t count = step > 0 ? (whole->count() + step - 1) / step : 0;
  GroundTruth part;
  part.kind = whole->kind;
  part.exclusion = whole->exclusion;
  part.template_xy_m = Array<double>({count, 2});
  part.points_m = Array<double>({count, 3});
  for (std::int64_t i = 0; i < count; ++i) {
    for (int k = 0; k < 2; ++k) part.template_xy_m(i, k) = whole->template_xy_m(step * i, k);
    for (int k = 0; k < 3; ++k) part.points_m(i, k) = whole->points_m(step * i, k);
  }
  return Record::copy_of(part);
}

void KeptFrames::add(std::uint64_t index, const RecordPtr& shape, const RecordPtr& truth) {
  if (index % stride_ != 0 || shape == nullptr) return;
  frames_.push_back({index, shape, truth});
  if (frames_.size() <= kMostKeptFrames) return;
  stride_ *= 2;
  std::erase_if(frames_, [&](const Frame& frame) { return frame.index % stride_ != 0; });
}

host::NamedRecords KeptFrames::records() const {
  host::NamedRecords records;
  for (const Frame& frame : frames_) {
    const std::string name = fmt::format("{:06}", frame.index);
    records.emplace_back(name + ".shape", frame.shape);
    if (frame.truth != nullptr) records.emplace_back(name + ".ground_truth", frame.truth);
  }
  return records;
}

}  // namespace weft::lab
