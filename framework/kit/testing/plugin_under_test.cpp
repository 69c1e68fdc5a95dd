// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <optional>
#include <stdexcept>
#include <weft/testing/plugin_under_test.hpp>

#include "host/calling/execution_context.hpp"

namespace weft::testing {

struct PluginUnderTest::Host {
  explicit Host(std::uint64_t run_seed)
      : registry(host::Registry::scan(host::search_path({}))), context(run_seed, {}) {}

  PluginAnswer keep(host::Outcome outcome) {
    for (const auto& [slot, record] : outcome.outputs) kept.push_back(record);
    return {outcome.status,
            outcome.error.code,
            outcome.error.message,
            outcome.error.where,
            {outcome.outputs.begin(), outcome.outputs.end()}};
  }

  host::Registry registry;
  host::ExecutionContext context;
  std::optional<host::ComponentSpec> spec;
  host::Instance* instance = nullptr;
  std::vector<HostRecord> kept;
  std::optional<double> budget_ms;
};

PluginUnderTest::PluginUnderTest(const std::string& id, const std::string& params,
                                 std::uint64_t run_seed)
    : host_(std::make_unique<Host>(run_seed)) {
  const auto document = yaml::parse("use: " + id + "\nparams: " + params + "\n", "params");
  if (!document) throw std::runtime_error(document.error().where + ": " + document.error().message);
  std::vector<yaml::Problem> problems = document->problems;
  if (problems.empty()) {
    host_->spec = host::resolve_component(host_->registry, *document->root.find("use"),
                                          document->root.find("params"),
                                          host::PathRules::of_process({"/"}, "/tmp"), problems);
  }
  if (!problems.empty()) throw std::runtime_error(problems.front().message);
  const auto instance = host_->context.instantiate(*host_->spec, "test");
  if (!instance) throw std::runtime_error(instance.error().message);
  host_->instance = *instance;
}

PluginUnderTest::~PluginUnderTest() = default;

std::atomic<bool>& PluginUnderTest::cancel() { return host_->context.cancellation().flag(); }

void PluginUnderTest::watch(std::function<bool()> cancelled) {
  host_->context.cancellation().watch(std::move(cancelled));
}

void PluginUnderTest::set_budget_ms(double budget_ms) { host_->budget_ms = budget_ms; }

void PluginUnderTest::forget() {
  host_->kept.clear();
  host_->context.times().take();
}

Result<void> PluginUnderTest::prepare(const Template& templ, const Camera& camera) {
  return host_->context.prepare(*host_->instance, *hold(templ), *hold(camera));
}

PluginAnswer PluginUnderTest::process(int method, const std::vector<Input>& inputs,
                                      std::uint64_t frame) {
  std::vector<weft_record> views;
  for (const Input& given : inputs) views.push_back(given.record->view(given.slot.c_str()));
  host::SteadyTime deadline = host::kNoDeadline;
  if (host_->budget_ms) {
    const std::chrono::duration<double, std::milli> left(*host_->budget_ms);
    deadline = host::SteadyTime::clock::now() +
               std::chrono::duration_cast<host::SteadyTime::duration>(left);
  }
  return host_->keep(host_->context.call(*host_->instance, method, views, frame, 0, deadline));
}

PluginAnswer PluginUnderTest::evaluate(const Warp& warp, const Points& points) {
  return host_->keep(host_->context.evaluate(*hold(warp), points, 0));
}

}  // namespace weft::testing
