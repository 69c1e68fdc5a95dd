// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>
#include <weft/testing/plugin_under_test.hpp>

#include "host/calling/execution_context.hpp"
#include "host/records/npz.hpp"

namespace weft::bench {

/// The struct as a record, with its revision: caches hold as they do in a run.
template <class RecordType>
host::RecordPtr record_of(const RecordType& typed) {
  return testing::input("", typed).record;
}

/// A component called as the host does, with inputs that are made once.
class Component {
 public:
  /// Throws std::runtime_error when it is refused.
  Component(const std::string& id, const std::string& params, const Template& templ,
            const Camera& camera);

  /// Throws when the component has no result.
  host::Outcome call(const host::NamedRecords& inputs, int method = 0);

 private:
  host::Registry registry_;
  host::ExecutionContext context_{1, {}};
  std::optional<host::ComponentSpec> spec_;
  host::Instance* instance_ = nullptr;
};

}  // namespace weft::bench
