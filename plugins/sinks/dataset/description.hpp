// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>

namespace weft::dataset {

/// The contents of a sequence, once all of it is written.
struct Contents {
  std::int64_t frames = 0;
  std::int64_t frames_with_truth = 0;
  std::string truth_kind;  ///< kind of the first truth
  double first_s = 0.0;    ///< [] s, time of the first frame
  double last_s = 0.0;     ///< [] s, time of the last frame
};

/// The camera file of sources/images.
std::string camera_text(const Camera& camera);

/// meta.yaml: what the sequence holds, and in which units.
std::string meta_text(const Camera& camera, const Template& templ, const Contents& contents);

/// sequence.yaml: the beginning of a pipeline that reads the sequence; others may extend it.
std::string sequence_text(const Template& templ, const Contents& contents);

}  // namespace weft::dataset
