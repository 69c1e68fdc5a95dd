// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>

#include "frame.hpp"

namespace weft::live {

/// The messages of the protocol weft.live.1, as the tables in the README have them.

/// The data that do not change in a run: `"weft":..,"camera":{..},"template":{..}`.
std::string scene_members(const Template& templ, const Camera& camera);

/// Each of `settings` and `started_with`, the settings of the run's first frame, is a JSON object,
/// or empty where nothing is known.
std::string hello_message(const std::string& scene, const std::string& settings,
                          const std::string& started_with);
std::string settings_message(const std::string& settings);
std::string answer_message(std::uint64_t number, std::uint64_t frame, const std::string& refusal);
/// The pause state of the run, whichever client requested it.
std::string pause_message(bool is_paused, std::uint64_t frame, bool has_left = false);
std::string still_message(bool is_still);
/// `state` is a JSON object, of Calibrator.
std::string calibration_message(const std::string& state);

/// `jpeg` is the image, or empty.
std::string frame_message(const FrameCopy& frame, const std::string& jpeg);

/// A message of a client of weft.live.1.
struct Said {
  bool is_change_request = false;  ///< else it is ready for a frame
  std::uint64_t number = 0;
  std::string text;
};

/// The error is the reason for which the client is closed.
Result<Said> parse_said(std::string_view message);

}  // namespace weft::live
