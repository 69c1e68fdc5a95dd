// SPDX-License-Identifier: Apache-2.0
// weft_abi_host
//
// Calls the components of the libraries in WEFT_PLUGIN_PATH, each method of each role, on the
// output of the first ones. Prints their answers to the last bit: a line for each call, and one for
// each refused file or component. Exit code: 0 unless an existing component could not be called.
#include <charconv>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <map>
#include <weft/testing/plugin_under_test.hpp>

#include "host/loading/registry.hpp"
#include "host/records/record.hpp"

namespace {

using namespace weft;
using namespace weft::testing;

template <class T>
void print_elements(const weft_array& array, std::int64_t count) {
  const T* data = static_cast<const T*>(array.data);
  for (std::int64_t i = 0; i < count; ++i) {
    char text[64];
    const auto [end, error] = std::to_chars(text, text + sizeof(text), data[i]);
    std::cout << ' ' << std::string_view(text, static_cast<std::size_t>(end - text));
  }
}

void print_array(const weft_array& array) {
  std::cout << "  " << array.name << ' ' << dtype_name(array.dtype) << " [";
  std::int64_t count = 1;
  for (int axis = 0; axis < array.ndim; ++axis) {
    std::cout << (axis > 0 ? "," : "") << array.shape[axis];
    count *= array.shape[axis];
  }
  std::cout << "]";
  switch (array.dtype) {
    case WEFT_U8:
      print_elements<std::uint8_t>(array, count);
      break;
    case WEFT_U16:
      print_elements<std::uint16_t>(array, count);
      break;
    case WEFT_I32:
      print_elements<std::int32_t>(array, count);
      break;
    case WEFT_I64:
      print_elements<std::int64_t>(array, count);
      break;
    case WEFT_F32:
      print_elements<float>(array, count);
      break;
    case WEFT_F64:
      print_elements<double>(array, count);
      break;
    default:
      std::cout << " (elements are not shown)";
  }
  std::cout << '\n';
}

constexpr const char* kStatus[] = {"ok", "degenerate", "no result", "error", "cancelled", "end"};

/// The answers of components, passed on under the names of inputs.
class Scene {
 public:
  explicit Scene(const std::vector<std::string>& ids) : ids_(ids) {}

  void call(const std::string& id, const char* what, int method,
            const std::vector<const char*>& inputs, std::uint64_t frame = 0) {
    PluginUnderTest& plugin = made(id);
    std::vector<Input> given;
    for (const char* slot : inputs) {
      const auto found = known_.find(slot);
      if (found != known_.end()) given.push_back({slot, found->second});
    }
    const PluginAnswer answer = plugin.process(method, given, frame);
    std::cout << id << ' ' << what << ": " << kStatus[answer.status];
    if (!answer.message.empty()) std::cout << " (" << answer.message << ')';
    std::cout << '\n';
    for (const auto& [slot, record] : answer.outputs) {
      const weft_record view = record->view(slot.c_str());
      std::cout << " " << slot << ' ' << view.type << '\n';
      for (std::uint64_t i = 0; i < view.count; ++i) print_array(view.arrays[i]);
      if (known_.count(slot) == 0) known_.emplace(slot, record);
    }
  }

  void name(const char* slot, const char* as) {
    if (const auto found = known_.find(slot); found != known_.end()) {
      known_.insert_or_assign(as, found->second);
    }
  }
  void forget(const char* slot) { known_.erase(slot); }

  /// The components of this role, ordered by name.
  std::vector<std::string> of(const std::string& role) const {
    std::vector<std::string> found;
    for (const std::string& id : ids_) {
      if (id.starts_with(role + "/")) found.push_back(id);
    }
    return found;
  }

 private:
  PluginUnderTest& made(const std::string& id) {
    auto& plugin = plugins_[id];
    if (plugin != nullptr) return *plugin;
    plugin = std::make_unique<PluginUnderTest>(id);
    const auto templ = known_.find("template"), camera = known_.find("camera");
    if (templ == known_.end() || camera == known_.end()) return *plugin;
    const auto ready =
        plugin->prepare(*typed_in<Template>(templ->second), *typed_in<Camera>(camera->second));
    if (!ready) std::cout << id << " prepare: " << ready.error().message << '\n';
    return *plugin;
  }

  std::vector<std::string> ids_;
  std::map<std::string, std::unique_ptr<PluginUnderTest>> plugins_;
  std::map<std::string, HostRecord> known_;
};

void call_all(Scene& scene) {
  for (const std::string& id : scene.of("sources")) {
    scene.call(id, "open", 0, {});
    scene.call(id, "count", 1, {});
    scene.call(id, "read 0", 2, {}, 0);
    scene.call(id, "read 9", 2, {}, 9);
  }
  for (const std::string& id : scene.of("templates")) scene.call(id, "build", 0, {});
  for (const std::string& id : scene.of("detectors")) scene.call(id, "detect", 0, {"image"});
  scene.name("keypoints", "template_keypoints");
  for (const std::string& id : scene.of("matchers")) {
    scene.call(id, "match", 0, {"keypoints", "template_keypoints"});
    scene.call(id, "match of nothing", 0, {"keypoints"});
  }
  for (const std::string& id : scene.of("filters")) {
    scene.call(id, "filter 3", 0, {"correspondences", "template", "camera"}, 3);
    scene.call(id, "filter 4", 0, {"correspondences", "template"}, 4);
  }
  for (const std::string& id : scene.of("warps")) {
    scene.call(id, "fit", 0, {"correspondences", "template"});
  }
  for (const std::string& id : scene.of("passes")) {
    scene.call(id, "run", 0, {"template", "camera"});
  }
  for (const std::string& id : scene.of("solvers")) {
    scene.call(id, "solve", 0, {"template", "camera", "correspondences"});
  }
  for (const std::string& id : scene.of("stages")) {
    scene.call(id, "run", 0, {"image"});
    scene.name("kept.brightness", "previous.kept.brightness");
    scene.call(id, "run again", 0, {"image", "previous.kept.brightness"}, 1);
  }
  for (const std::string& id : scene.of("sinks")) {
    scene.call(id, "open", 0, {});
    scene.call(id, "write", 1, {"shape", "image"});
    scene.call(id, "finish", 2, {});
  }
}

}  // namespace

int main() try {
  const host::Registry registry = host::Registry::scan(host::search_path({}));
  for (const host::Refusal& refusal : registry.refusals()) {
    std::cout << "refused " << std::filesystem::path(refusal.file).filename().string() << ": "
              << refusal.cause << '\n';
  }
  std::vector<std::string> ids;
  for (const host::Installed& entry : registry.installed()) ids.push_back(entry.component.id);
  std::sort(ids.begin(), ids.end());
  Scene scene(ids);
  call_all(scene);
  return 0;
} catch (const std::exception& wrong) {
  std::cerr << wrong.what() << '\n';
  return 1;
}
