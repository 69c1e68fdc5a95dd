// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/npz_members.hpp>

namespace weft::sources {

/// The record `ground_truth` of one frame from an npz file, as sinks/dataset and run folders hold
/// it.
class TruthArchive {
 public:
  /// Fails on a file that is no such archive or is damaged.
  static Result<TruthArchive> read(const std::string& path);

  /// Borrows from this. Fails on an array that is missing or of another type or shape.
  Result<GroundTruth> truth() const;

 private:
  TruthArchive(std::string path, NpzRecord record);

  std::string path_;
  NpzRecord record_;
};

}  // namespace weft::sources
