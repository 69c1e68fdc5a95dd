// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <type_traits>
#include <weft/sdk/component_checks.hpp>
#include <weft/sdk/extensions.hpp>
#include <weft/sdk/isa.hpp>
#include <weft/sdk/role.hpp>

#ifndef WEFT_NEEDS_MINOR
#define WEFT_NEEDS_MINOR 0
#endif

namespace weft::detail {

/// The functions of the contract for one component class.
template <class T>
struct Functions {
  static std::int32_t describe(const weft_describe* sink, weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      Params params(sink);
      T component(params);
      for (const RoleMethod& method : T::role().methods) {
        for (const RoleSlot& slot : method.inputs) sink->record(sink->context, slot.type.c_str());
        for (const RoleSlot& slot : method.outputs) sink->record(sink->context, slot.type.c_str());
      }
      if constexpr (requires { T::describe_slots(sink, about_of<T>()); }) {
        const auto described = T::describe_slots(sink, about_of<T>());
        if (!described) return report(described.error(), error);
      }
      return WEFT_OK;
    });
  }
  static std::int32_t create(const weft_create* with, void** self, weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      Params params(with->values, with->count);
      auto created = std::make_unique<T>(params);
      if (!params.status()) return report(params.status().error(), error);
      *self = created.release();
      return WEFT_OK;
    });
  }
  static std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                              std::uint64_t count, weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      if constexpr (std::is_base_of_v<Prepared, T>) {
        const StopCheck check = Call(*call).stop_check();
        ProcessCall process(*call, inputs, count, error);
        return process.run_with<PrepareInput>(
            [&](const PrepareInput& in) {
              Prepared& prepared =
                  *static_cast<T*>(self);  // also works if T overrides it as private
              return prepared.prepare(in);
            },
            [](const auto&) { return Result<void>{}; });
      }
      return WEFT_OK;
    });
  }
  static std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                              std::uint64_t count, weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      if (call->method < 0 || call->method >= 64 || (T::kMethods >> call->method & 1U) == 0) {
        const std::string number = std::to_string(call->method);
        return report({Errc::unsupported, "has no method " + number + " of its role", {}}, error);
      }
      const StopCheck check = Call(*call).stop_check();
      ProcessCall process(*call, inputs, count, error);
      return static_cast<T*>(self)->process(process);
    });
  }
  static void destroy(void* self) { delete static_cast<T*>(self); }
};

template <class T>
constexpr weft_component make_component(const char* id, const char* version, const char* summary) {
  constexpr About kAbout = about_of<T>();
  return {sizeof(weft_component),
          (kAbout.random ? WEFT_FLAG_RANDOM : 0U) | (kAbout.uses_truth ? WEFT_FLAG_USES_TRUTH : 0U),
          id,
          version,
          summary,
          kAbout.reference,
          kAbout.licence,
          kAbout.determinism,
          kAbout.needs,
          kAbout.reads,
          kAbout.produces,
          T::kMethods,
          &Functions<T>::describe,
          &Functions<T>::create,
          &Functions<T>::prepare,
          &Functions<T>::process,
          &Functions<T>::destroy,
          &Extensions<T>::get};
}

template <class T, FixedText kId>
constexpr weft_component checked_component(const char* id, const char* version,
                                           const char* summary) {
  check_component<T, kId>();
  return make_component<T>(id, version, summary);
}

template <std::size_t Count>
constexpr std::array<const weft_component*, Count> pointers_to(
    const std::array<weft_component, Count>& components) {
  std::array<const weft_component*, Count> pointers{};
  for (std::size_t i = 0; i < Count; ++i) pointers[i] = &components[i];
  return pointers;
}

}  // namespace weft::detail

/// One component of a library: class, id, version and summary.
#define WEFT_COMPONENT(Class, id, version, summary) \
  ::weft::detail::checked_component<Class, id>(id, version, summary)

/// A library of several components. It works with every host of this major version. A library that
/// uses functions of a later minor version defines WEFT_NEEDS_MINOR before it includes the SDK.
#define WEFT_LIBRARY(...)                                                        \
  namespace {                                                                    \
  constexpr auto kWeftComponents = std::to_array<weft_component>({__VA_ARGS__}); \
  constexpr auto kWeftPointers = ::weft::detail::pointers_to(kWeftComponents);   \
  }                                                                              \
  const weft_library_table weft_library = {WEFT_ABI_MAGIC,                       \
                                           WEFT_ABI_MAJOR,                       \
                                           WEFT_ABI_MINOR,                       \
                                           sizeof(weft_library_table),           \
                                           kWeftComponents.size(),               \
                                           WEFT_ABI_NAME,                        \
                                           kWeftPointers.data(),                 \
                                           WEFT_ISA,                             \
                                           WEFT_COMPILER,                        \
                                           WEFT_NEEDS_MINOR,                     \
                                           0,                                    \
                                           0,                                    \
                                           {0, 0, 0, 0}};

/// A library of one component.
#define WEFT_PLUGIN(Class, id, version, summary) \
  WEFT_LIBRARY(WEFT_COMPONENT(Class, id, version, summary))
