// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/cameras/camera_builder.hpp"
#include "common/cameras/camera_formats.hpp"
#include "common/cameras/camera_values.hpp"

namespace weft::cameras {

/// The values of a file below one path, in one format. Throws FileMistake where a number is due and
/// the file has none.
class FormatValues {
 public:
  FormatValues(const CameraValues& values, const Format& format, std::string prefix)
      : values_(values), format_(format), prefix_(std::move(prefix)) {}

  const Value* find(const std::string& paths) const { return values_.find(prefix_, paths); }

  /// The numbers of a list, or those under `data` of what OpenCV and ROS write as rows, cols, data.
  const Value* list(const std::string& paths) const;

  const Word& word(const Value& value) const;
  std::vector<double> numbers(const Value& value) const;

  /// 0 where nothing is there.
  double optional_number(const std::string& path) const;

 protected:
  const CameraValues& values_;
  const Format& format_;
  std::string prefix_;
};

/// Sets the lens of the camera from these values.
void read_lens(const FormatValues& values, CameraBuilder& camera);

}  // namespace weft::cameras
