// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>
#include <vector>
#include <weft/sdk/process.hpp>

namespace weft {

/// One input or output of a role's method.
struct RoleSlot {
  std::string name;  ///< "correspondences", "previous.shape"
  std::string type;  ///< record type, "correspondences/1"
  bool required;     ///< required in every use of the role
};

struct RoleMethod {
  std::string name;               ///< name of the method: "read"
  std::vector<RoleSlot> inputs;   ///< [.] consumed slots
  std::vector<RoleSlot> outputs;  ///< [.] produced slots
};

/// Inputs and outputs of a role; method numbers are positions in `methods`.
struct Role {
  std::string name;                 ///< name of the folder: "filters"
  std::vector<RoleMethod> methods;  ///< [.] methods by number
};

namespace detail {

template <class T>
struct SlotRecord {
  using RecordType = T;
  static constexpr bool kRequired = true;
};
template <class T>
struct SlotRecord<OptionalInput<T>> {
  using RecordType = T;
  static constexpr bool kRequired = false;
};
template <class T>
struct SlotRecord<ListInput<T>> {
  using RecordType = T;
  static constexpr bool kRequired = false;
};

}  // namespace detail

template <class RecordType>
RoleSlot output_slot(const char* name, bool required = true) {
  return {name, RecordType::kType, required};
}

/// A method whose inputs are the slots of `Input`.
template <class Input>
RoleMethod role_method(const char* name, std::vector<RoleSlot> outputs) {
  RoleMethod method{name, {}, std::move(outputs)};
  const weft_call no_call{};
  Input input{Call(no_call)};
  Input::slots(input, [&](const char* slot, auto& member) {
    using Slot = detail::SlotRecord<std::remove_cvref_t<decltype(member)>>;
    method.inputs.push_back({slot, Slot::RecordType::kType, Slot::kRequired});
  });
  return method;
}

/// Base of the roles that are prepared once: all roles except sources and templates.
class Prepared {
 public:
  static constexpr About kAbout{};
  virtual ~Prepared() = default;
  /// Called once before the first frame, for files, devices and checks across parameters.
  virtual Result<void> prepare(const PrepareInput& /*in*/) { return {}; }
};

/// An input without slots, for calls without inputs.
struct EmptyInput {
  Call call;

  template <class Self, class Visit>
  static void slots(Self& /*self*/, Visit&& /*visit*/) {}
};

}  // namespace weft
