// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <weft/core/component_id.hpp>
#include <weft/sdk/export.hpp>
#include <weft/sdk/nested.hpp>
#include <weft/sdk/role.hpp>

namespace weft {

namespace detail {

template <class T>
struct OutputRecord {
  using RecordType = T;
  static constexpr bool kRequired = true;
};
template <class T>
struct OutputRecord<std::optional<T>> {
  using RecordType = T;
  static constexpr bool kRequired = false;
};

template <class Member>
struct ElementOf {  ///< for arrays outside the record type: named arrays and diagnostics
  static constexpr std::int32_t kDtype = 0;
};
template <class T>
struct ElementOf<Array<T>> {
  static constexpr std::int32_t kDtype = dtype_of<T>();
};
template <class T>
requires std::is_arithmetic_v<T>
struct ElementOf<T> {
  static constexpr std::int32_t kDtype = dtype_of<T>();
};
template <>
struct ElementOf<std::string> {
  static constexpr std::int32_t kDtype = WEFT_U8;
};

/// Declares each array of a vendor's record type to the host, which already has its own types.
template <class RecordType>
void describe_record(const weft_describe* sink) {
  if constexpr (is_vendor_record(RecordType::kType)) {
    const RecordType record{};
    RecordType::fields(record, [&]<class Member>(const Member&, const Field& field) {
      constexpr std::int32_t kDtype = ElementOf<Member>::kDtype;
      if (kDtype == 0) return;
      const weft_field declared{sizeof(weft_field),
                                (field.optional ? WEFT_FIELD_OPTIONAL : 0U) |
                                    (field.may_be_nan ? WEFT_FIELD_MAY_BE_NAN : 0U),
                                field.name,
                                field.shape,
                                field.unit,
                                field.meaning,
                                kDtype,
                                0};
      sink->field(sink->context, RecordType::kType, &declared);
    });
  }
}

inline bool names(std::string_view list, std::string_view wanted) {
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(' '), list.size());
    if (list.substr(0, end) == wanted) return true;
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return false;
}

}  // namespace detail

/// Role `stages`: components that fit no other role, with their own choice of inputs and outputs.
/// Both are structs with slots, like weft::PassInput; a member of Output may be a std::optional. A
/// slot has the name of another role's input, "image", or of a vendor's record type without
/// version, "acme.depth" for "acme.depth/1". The prefix "previous." is allowed. The role produces
/// vendor records and the outputs of passes. kAbout lists all of its slots.
template <class Input, class Output>
class Stage : public Prepared {
 public:
  static constexpr const char* kRole = "stages";
  virtual Result<Output> run(const Input& in) = 0;

  static constexpr std::uint64_t kMethods = 0b1;
  static Role role() {
    std::vector<RoleSlot> outputs;
    const Output output{};
    Output::slots(output, [&]<class Member>(const char* slot, const Member&) {
      using Slot = detail::OutputRecord<Member>;
      outputs.push_back({slot, Slot::RecordType::kType, Slot::kRequired});
    });
    return {kRole, {role_method<Input>("run", std::move(outputs))}};
  }

  std::int32_t process(ProcessCall& call) {
    return call.run_with<Input>([&](const auto& in) { return run(in); },
                                [&](const Output& out) {
                                  Result<void> status;
                                  Output::slots(out, [&](const char* slot, const auto& member) {
                                    if (status) status = call.write(slot, member);
                                  });
                                  return status;
                                });
  }

  /// Declares the arrays of its vendor record types. Fails if kAbout and the structs disagree about
  /// a slot.
  static Result<void> describe_slots(const weft_describe* sink, const About& about) {
    const weft_call no_call{};
    Input input{Call(no_call)};
    std::string wrong;
    const auto expect = [&](std::string_view list, const char* slot, const char* member) {
      if (!detail::names(list, slot) && wrong.empty()) {
        wrong = std::string("its slot '") + slot + "' is missing in kAbout." + member;
      }
    };
    Input::slots(input, [&](const char* slot, auto& member) {
      using Slot = detail::SlotRecord<std::remove_cvref_t<decltype(member)>>;
      expect(Slot::kRequired ? about.needs : about.reads, slot,
             Slot::kRequired ? "needs" : "reads, and it is optional");
      detail::describe_record<typename Slot::RecordType>(sink);
    });
    const Output output{};
    Output::slots(output, [&]<class Member>(const char* slot, const Member&) {
      expect(about.produces, slot, "produces");
      detail::describe_record<typename detail::OutputRecord<Member>::RecordType>(sink);
    });
    return wrong.empty() ? Result<void>{} : Error{Errc::invalid_value, wrong, {}};
  }
};

}  // namespace weft
