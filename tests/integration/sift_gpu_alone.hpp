// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <cstring>
#include <weft/host/lane.hpp>
#include <weft/host/registry.hpp>

#include "common/tests/scenes.hpp"

namespace weft::sift_gpu {

using detectors::texture;

/// The plugin in a lane of its own, so that its calls can be cancelled and its answers forgotten.
class PluginInALane {
 public:
  explicit PluginInALane(const std::string& params = "{}")
      : registry_(host::Registry::scan(host::search_path({}))) {
    const auto document =
        yaml::parse("use: detectors/sift_gpu\nparams: " + params + "\n", "params");
    std::vector<yaml::Problem> problems;
    spec_ = host::resolve_component(registry_, *document->root.find("use"),
                                    document->root.find("params"),
                                    host::PathRules::of_process({"/"}, "/tmp"), problems);
    if (!spec_) throw std::runtime_error(problems.front().message);
    const auto made = lane_.instantiate(*spec_, "test");
    if (!made) throw std::runtime_error(made.error().message);
    instance_ = *made;
  }

  host::Outcome detect(const Image& image) {
    const RecordView<Image> view("image", image);
    lane_.take_timings();
    return lane_.call(*instance_, 0, {&view.raw(), 1}, 0);
  }

  std::atomic<bool>& cancel() { return lane_.cancel(); }

 private:
  host::Registry registry_;
  host::Lane lane_{1, {}};
  std::optional<host::ComponentSpec> spec_;
  host::Instance* instance_ = nullptr;
};

/// Whether two answers are equal to the bit; false if either has no keypoints.
inline bool same_keypoints(const host::Outcome& a, const host::Outcome& b) {
  if (a.status != WEFT_OK || b.status != WEFT_OK) return false;
  const auto here = a.find("keypoints")->in_host_memory();
  const auto there = b.find("keypoints")->in_host_memory();
  if (!here || !there) return false;
  const auto first = host::view_as<Keypoints>(**here);
  const auto second = host::view_as<Keypoints>(**there);
  const auto equal = [](const auto& one, const auto& other) {
    return one.size() == other.size() &&
           std::memcmp(one.data(), other.data(),
                       static_cast<std::size_t>(one.size()) * sizeof(*one.data())) == 0;
  };
  return first->count() > 0 && equal(first->xy_px, second->xy_px) &&
         equal(first->scale_px, second->scale_px) && equal(first->angle_rad, second->angle_rad) &&
         equal(first->response, second->response) && equal(first->octave, second->octave) &&
         equal(first->descriptors, second->descriptors);
}

}  // namespace weft::sift_gpu
