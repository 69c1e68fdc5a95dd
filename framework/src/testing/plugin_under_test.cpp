// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>
#include <weft/testing/plugin_under_test.hpp>

namespace weft::testing {
PluginUnderTest::PluginUnderTest(const std::string& id, const std::string& params,
                                 std::uint64_t run_seed)
    : registry_(host::Registry::scan(host::search_path({}))), lane_(run_seed, {}) {
  const auto document = yaml::parse("use: " + id + "\nparams: " + params + "\n", "params");
  if (!document) throw std::runtime_error(document.error().where + ": " + document.error().message);
  std::vector<yaml::Problem> problems = document->problems;
  if (problems.empty()) {
    spec_ = host::resolve_component(registry_, *document->root.find("use"),
                                    document->root.find("params"),
                                    host::PathRules::of_process({"/"}, "/tmp"), problems);
  }
  if (!problems.empty()) throw std::runtime_error(problems.front().message);
  const auto instance = lane_.instantiate(*spec_, "test");
  if (!instance) throw std::runtime_error(instance.error().message);
  instance_ = *instance;
}

PluginUnderTest::~PluginUnderTest() = default;

Outcome PluginUnderTest::keep(host::Outcome outcome) {
  for (const auto& [slot, record] : outcome.outputs) kept_.push_back(record);
  return {outcome.status, outcome.error.code, outcome.error.message, outcome.error.where,
          std::move(outcome.outputs)};
}

void PluginUnderTest::forget() {
  kept_.clear();
  lane_.take_timings();
}

Result<void> PluginUnderTest::prepare(const Template& templ, const Camera& camera) {
  return lane_.prepare(*instance_, *input("template", templ).record,
                       *input("camera", camera).record);
}

Outcome PluginUnderTest::process(int method, const std::vector<Input>& inputs,
                                 std::uint64_t frame) {
  std::vector<weft_record> views;
  for (const Input& given : inputs) views.push_back(given.record->view(given.slot.c_str()));
  return keep(lane_.call(*instance_, method, views, frame));
}

Outcome PluginUnderTest::evaluate(const Warp& warp, const Points& points) {
  return keep(lane_.evaluate(*input("warp", warp).record, points, 0));
}

}  // namespace weft::testing
