// SPDX-License-Identifier: Apache-2.0
// weft_abi_host
//
// Calls the components of the libraries in WEFT_PLUGIN_PATH, each method of each role, on the
// output of the first ones. Prints their declarations and answers to the last bit, and a line for
// each refused file or component. Exit code: 0 unless an existing component could not be called.
// With --catalogue it prints the catalogue of records instead.
#include "host.hpp"

#include <charconv>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <map>
#include <weft/core/index.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "host/records/device_array.hpp"
#include "host/records/record.hpp"

namespace {

using namespace weft;
using namespace weft::testing;
using namespace weft::abi_test;

template <class T>
void print_elements(const weft_array& array, std::int64_t count) {
  const T* data = static_cast<const T*>(array.data);
  for (std::int64_t i = 0; i < count; ++i) {
    char text[64];
    const auto [end, error] = std::to_chars(text, text + sizeof(text), data[i]);
    std::cout << ' ' << std::string_view(text, static_cast<std::size_t>(end - text));
  }
}

/// A text that a plugin reports of itself.
void print_text(const weft_array& array) {
  const std::string_view text(static_cast<const char*>(array.data), to_index(array.shape[0]));
  std::cout << "  " << array.name << ": " << text << '\n';
}

void print_array(const weft_array& array) {
  if (array.memory == WEFT_DEVICE) {
    const auto copy = host::DeviceArray::of(array)->copy();
    if (!copy) throw std::runtime_error(copy.error().message);
    std::cout << "  on a device\n";
    return print_array(copy->array);
  }
  if (std::string_view(array.name) == "x.kept.values") return print_text(array);
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
    case WEFT_I8:
      print_elements<std::int8_t>(array, count);
      break;
    case WEFT_I16:
      print_elements<std::int16_t>(array, count);
      break;
    case WEFT_F16:  // its bits
    case WEFT_U16:
      print_elements<std::uint16_t>(array, count);
      break;
    case WEFT_U32:
      print_elements<std::uint32_t>(array, count);
      break;
    case WEFT_U64:
      print_elements<std::uint64_t>(array, count);
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
    if (answer.status == WEFT_ERROR) std::cout << ' ' << static_cast<int>(answer.code);
    if (!answer.message.empty()) std::cout << " (" << answer.message << ')';
    std::cout << '\n';
    for (const auto& [slot, record] : answer.outputs) {
      const weft_record view = record->view(slot.c_str());
      std::cout << " " << slot << ' ' << view.type << '\n';
      for (std::uint64_t i = 0; i < view.count; ++i) print_array(view.arrays[i]);
      if (known_.count(slot) == 0) known_.emplace(slot, record);
    }
  }

  /// Uses these parameters for a component from now on.
  void make(const std::string& id, const std::string& params) {
    plugins_[id] = std::make_unique<PluginUnderTest>(id, params);
  }

  void name(const char* slot, const char* as) {
    if (const auto found = known_.find(slot); found != known_.end()) {
      known_.insert_or_assign(as, found->second);
    }
  }
  void forget(const char* slot) { known_.erase(slot); }

  /// The components whose ids begin with this, ordered by name.
  std::vector<std::string> of(const std::string& beginning) const {
    std::vector<std::string> found;
    for (const std::string& id : ids_) {
      if (id.starts_with(beginning)) found.push_back(id);
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

/// Values of all types, and limits of the ranges.
constexpr const char* kParams =
    "{number: 8, integer: 9007199254740992, flag: false, word: second, text: \"\\u00e4 b\", "
    "input: /dev/null, output: out/a.txt, nested: {use: detectors/kept.small, params: "
    "{brighter_than: 220}}, labels: {one: \"1\", two: \"2\"}, numbers: [], integers: [-8, 8], "
    "texts: [x, \"y z\"]}";
constexpr const char* kOutside = "{integer: 9007199254740994}";

/// A detector with every parameter and extension, in each status.
void call_every(Scene& scene, const host::Registry& registry, const std::string& id) {
  for (const char* params : {"{}", kParams, kOutside}) print_extensions(registry, id, params);
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    scene.call(id, ("detect " + std::to_string(frame)).c_str(), 0, {"image"}, frame);
  }
  scene.make(id, kParams);
  scene.call(id, "detect with parameters", 0, {"image"});
}

void call_all(Scene& scene, const host::Registry& registry) {
  for (const std::string& id : scene.of("sources/")) {
    scene.call(id, "open", 0, {});
    scene.call(id, "count", 1, {});
    scene.call(id, "read 0", 2, {}, 0);
    scene.call(id, "read 9", 2, {}, 9);
  }
  for (const std::string& id : scene.of("templates/")) scene.call(id, "build", 0, {});
  for (const std::string& id : scene.of("detectors/")) {
    if (!id.starts_with("detectors/kept.every")) scene.call(id, "detect", 0, {"image"});
  }
  for (const std::string& id : scene.of("detectors/kept.every")) call_every(scene, registry, id);
  scene.name("keypoints", "template_keypoints");
  for (const std::string& id : scene.of("matchers/")) {
    scene.call(id, "match", 0, {"keypoints", "template_keypoints"});
    scene.call(id, "match of nothing", 0, {"keypoints"});
  }
  for (const std::string& id : scene.of("filters/")) {
    scene.call(id, "filter 3", 0, {"correspondences", "template", "camera"}, 3);
    scene.call(id, "filter 4", 0, {"correspondences", "template"}, 4);
  }
  for (const std::string& id : scene.of("warps/")) {
    scene.call(id, "fit", 0, {"correspondences", "template"});
  }
  for (const std::string& id : scene.of("passes/")) {
    scene.call(id, "run", 0, {"template", "camera"});
  }
  for (const std::string& id : scene.of("solvers/")) {
    scene.call(id, "solve", 0, {"template", "camera", "correspondences"});
  }
  for (const std::string& id : scene.of("stages/")) {
    scene.call(id, "run", 0, {"image"});
    scene.name("kept.brightness", "previous.kept.brightness");
    scene.call(id, "run again", 0, {"image", "previous.kept.brightness"}, 1);
  }
  for (const std::string& id : scene.of("sinks/")) {
    print_extensions(registry, id, "{}");
    scene.call(id, "open", 0, {});
    scene.call(id, "write", 1, {"shape", "image"});
    scene.call(id, "finish", 2, {});
  }
}

}  // namespace

int main(int count, char** words) try {
  if (count > 1 && std::string_view(words[1]) == "--catalogue") {
    print_catalogue();
    return 0;
  }
  const host::Registry registry = host::Registry::scan(host::search_path({}));
  for (const host::Refusal& refusal : registry.refusals()) {
    std::cout << "refused " << std::filesystem::path(refusal.file).filename().string() << ": "
              << refusal.cause << '\n';
  }
  std::vector<std::string> ids;
  for (const host::Installed& entry : registry.installed()) ids.push_back(entry.component.id);
  std::sort(ids.begin(), ids.end());
  for (const std::string& id : ids) print_manifest(registry.find(id)->component);
  Scene scene(ids);
  call_all(scene, registry);
  return 0;
} catch (const std::exception& wrong) {
  std::cerr << wrong.what() << '\n';
  return 1;
}
