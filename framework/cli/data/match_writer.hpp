// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/ground_truth.hpp>

namespace weft::cli {

/// Writes a folder of matches that sources/matches reads: matches/NNNNNN.csv or .npz, gt/NNNNNN.npz
/// where points are known to be true, camera.yaml, and last sequence.yaml.
class MatchWriter {
 public:
  MatchWriter(std::string folder, std::string format)
      : folder_(std::move(folder)), format_(std::move(format)) {}

  /// Fails where something is in the folder.
  Result<void> begin(const weft::Camera& camera);

  /// Labels from the ground truth are written beside the matches.
  Result<void> add(std::uint64_t frame, const Correspondences& matches,
                   const std::optional<GroundTruth>& truth);

  /// Leaves what was there before begin(), which is nothing.
  void withdraw() const;

  /// `templ` is the pipeline's template as YAML, or empty.
  Result<void> end(const std::string& templ, double fps);

  std::int64_t frames() const { return frames_; }
  std::int64_t matches() const { return matches_; }

 private:
  std::string file(const char* part, std::uint64_t frame, const std::string& extension) const;

  std::string folder_, format_;
  bool begun_ = false;
  std::int64_t frames_ = 0, matches_ = 0, frames_with_points_ = 0;
};

}  // namespace weft::cli
