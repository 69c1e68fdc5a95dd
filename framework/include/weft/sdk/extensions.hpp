// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <iterator>
#include <new>
#include <string_view>
#include <weft/core/mistakes.hpp>
#include <weft/sdk/process.hpp>

namespace weft::detail {

/// Returns whether an exception reports a lack of memory; OpenCV has its own exception for it.
inline bool is_about_memory(const std::exception& thrown, std::string_view text) {
  return dynamic_cast<const std::bad_alloc*>(&thrown) != nullptr ||
         text.find("(-4:Insufficient memory)") != std::string_view::npos;
}

/// Runs `body` and converts an exception into an error, so that none crosses the boundary.
template <class Body>
std::int32_t guarded(weft_error* error, Body&& body) noexcept {
  try {
    return body();
  } catch (const Stopped&) {
    return report({Errc::cancelled, "cancelled", {}}, error);
  } catch (const NotDelivered& missing) {
    return report({Errc::plugin_failure, missing.what(), {}}, error);
  } catch (const std::exception& thrown) {
    const char* given = thrown.what();
    const std::string text = given != nullptr ? given : "an exception without a text";
    if (is_about_memory(thrown, text)) return report({Errc::no_memory, "out of memory", {}}, error);
    return report({Errc::plugin_failure, "threw: " + text, {}}, error);
  } catch (...) {
    return report({Errc::plugin_failure, "threw something that is no std::exception", {}}, error);
  }
}

template <class T>
constexpr About about_of() {
  if constexpr (requires { T::kAbout; }) {
    return T::kAbout;
  } else {
    return {};
  }
}

/// Extensions of a component class beyond its role, detected by its members.
template <class T>
struct Extensions {
  static const void* get(const weft_component* /*component*/, const char* name) {
    const std::string_view asked = name;
    if (asked == WEFT_DEVICE_MEMORY) return about_of<T>().device_memory;
    if constexpr (requires { T::devices(); }) {
      if (asked == WEFT_DEVICES) return &kDevices;
    }
    if constexpr (kChecks) {
      if (asked == WEFT_CHECK) return &kCheck;
    }
    if constexpr (kSweeps) {
      if (asked == WEFT_SWEEP) return &kSweepTable;
    }
    if constexpr (kSteers) {
      if (asked == WEFT_STEERING) return &kSteering;
    }
    return nullptr;
  }

 private:
  static constexpr bool kSweeps = requires { T::kSweep.parameter; };
  static constexpr bool kChecks = requires(const T& t, Mistakes& m) { t.check(m); };

  static constexpr bool kSteers = requires(T & t) { t.take_change_requests(); };

  static std::int32_t list_devices(void* context, void (*device)(void* context, const char* text),
                                   weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      if constexpr (requires { T::devices(); }) {
        for (const std::string& text : T::devices()) device(context, text.c_str());
      }
      return WEFT_OK;
    });
  }
  static std::int32_t check(void* self, void* context, Mistakes::Report mistake,
                            weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      Mistakes mistakes(context, mistake);
      if constexpr (kChecks) static_cast<const T*>(self)->check(mistakes);
      return WEFT_OK;
    });
  }
  static std::int32_t take_change_requests(void* self, void* context,
                                           void (*request)(void* context, std::uint64_t number,
                                                           const char* text),
                                           weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      if constexpr (kSteers) {
        for (const auto& each : static_cast<T*>(self)->take_change_requests()) {
          request(context, each.number, each.text.c_str());
        }
      }
      return WEFT_OK;
    });
  }
  static std::int32_t answer(void* self, std::uint64_t number, std::uint64_t frame,
                             const char* refusal, weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      if constexpr (kSteers) static_cast<T*>(self)->answer({number, frame, refusal});
      return WEFT_OK;
    });
  }

  static constexpr weft_sweep sweep_table() {
    if constexpr (kSweeps) {
      return {sizeof(weft_sweep), 0, T::kSweep.parameter, T::kSweep.values,
              std::size(T::kSweep.values)};
    } else {
      return {};
    }
  }

  static constexpr weft_sweep kSweepTable = sweep_table();
  static constexpr weft_devices kDevices{sizeof(weft_devices), 0, &list_devices};
  static constexpr weft_check kCheck{sizeof(weft_check), 0, &check};
  static constexpr weft_steering kSteering{sizeof(weft_steering), 0, &take_change_requests,
                                           &answer};
};

}  // namespace weft::detail
