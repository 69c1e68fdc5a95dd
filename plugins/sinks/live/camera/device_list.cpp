// SPDX-License-Identifier: Apache-2.0
#include "camera/device_list.hpp"

#include <nlohmann/json.hpp>

namespace weft::live {

std::string device_list(const std::vector<capture_devices::Device>& devices) {
  using nlohmann::ordered_json;
  ordered_json list = ordered_json::array();
  for (const capture_devices::Device& device : devices) {
    ordered_json modes = ordered_json::array();
    for (const auto& [format, width_px, height_px, fps] : device.modes) {
      modes.push_back(
          {{"format", format}, {"width_px", width_px}, {"height_px", height_px}, {"fps", fps}});
    }
    ordered_json each{{"device", device.number}, {"name", device.name}, {"modes", modes}};
    if (const auto& range = device.exposure_ms) {
      each["exposure_ms"] = {range->first, range->second};
    }
    if (!device.fault.empty()) each["fault"] = device.fault;
    list.push_back(std::move(each));
  }
  return ordered_json{{"cameras", std::move(list)}}.dump(-1, ' ', false,
                                                         ordered_json::error_handler_t::replace);
}

}  // namespace weft::live
