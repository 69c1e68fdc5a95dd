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
struct ElementOf {  ///< of what is no array of the record type's own: named arrays, diagnostics
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

/// Tells the host of each array of a vendor's record type; it knows its own.
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

/// Role `stages`: what fits no other role, with inputs and outputs of its own choice. Both are
/// structs with slots, as weft::PassInput is; a member of Output may be a std::optional. A slot is
/// called as that of another role's input, "image", or as a record type of a vendor without its
/// version, "acme.depth" of "acme.depth/1"; before either may stand "previous.". It makes records
/// of vendors, and what passes make. kAbout names all of its slots.
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

  /// The arrays of its vendor's record types. Fails where kAbout does not say of a slot what the
  /// structs say.
  static Result<void> describe_slots(const weft_describe* sink, const About& about) {
    const weft_call no_call{};
    Input input{Call(no_call)};
    std::string wrong;
    const auto expect = [&](std::string_view list, const char* slot, const char* member) {
      if (!detail::names(list, slot) && wrong.empty()) {
        wrong = std::string("its slot '") + slot + "' does not stand in kAbout." + member;
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
