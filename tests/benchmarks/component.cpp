// SPDX-License-Identifier: Apache-2.0
#include "component.hpp"

#include <stdexcept>

namespace weft::bench {
namespace {

template <class T>
T need(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().where + ": " + result.error().message);
  return *std::move(result);
}

}  // namespace

Component::Component(const std::string& id, const std::string& params, const Template& templ,
                     const Camera& camera)
    : registry_(host::Registry::scan(host::search_path({}))) {
  const auto document = need(yaml::parse("{use: " + id + ", params: " + params + "}", id));
  std::vector<yaml::Problem> problems;
  spec_ =
      host::resolve_component(registry_, *document.root.find("use"), document.root.find("params"),
                              host::PathRules::of_process({"/"}, "/tmp"), problems);
  if (!spec_) throw std::runtime_error(id + ": " + problems.front().message);
  instance_ = need(context_.instantiate(*spec_, id));
  const auto ready = context_.prepare(*instance_, *record_of(templ), *record_of(camera));
  if (!ready) throw std::runtime_error(id + ": " + ready.error().message);
}

host::Outcome Component::call(const host::NamedRecords& inputs, int method) {
  std::vector<weft_record> views;
  for (const auto& [slot, record] : inputs) views.push_back(record->view(slot.c_str()));
  host::Outcome outcome = context_.call(*instance_, method, views, 0);
  context_.times().take();
  if (!outcome.usable()) throw std::runtime_error(outcome.error.message);
  return outcome;
}

}  // namespace weft::bench
