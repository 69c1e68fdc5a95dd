// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>
#include <weft/data/warp.hpp>
#include <weft/testing/host_record.hpp>

namespace weft::testing {

/// A record struct as an input of a call.
struct Input {
  std::string slot;
  HostRecord record;
};

/// Copies the struct.
template <class RecordType>
Input input(const char* slot, const RecordType& typed) {
  return {slot, hold(typed)};
}

/// Answer of a component to a call. Record structs from it live as long as the PluginUnderTest, or
/// until forget().
struct PluginAnswer {
  weft_status status = WEFT_OK;
  Errc code = {};       ///< set unless the call succeeded
  std::string message;  ///< reason of an error or of a degenerate answer
  std::string where;    ///< subject of an error, such as a file; else the component
  std::vector<std::pair<std::string, HostRecord>> outputs;  ///< [.] slot and record of each output

  /// The first output of this type, if there is one.
  template <class RecordType>
  std::optional<RecordType> get() const {
    for (const auto& [slot, record] : outputs) {
      if (auto typed = typed_in<RecordType>(record)) return typed;
    }
    return std::nullopt;
  }

  /// An output as the input of another call, in device memory if it is there.
  Input hand_on(std::string_view output, const char* as) const {
    for (const auto& [slot, record] : outputs) {
      if (slot == output) return {as, record};
    }
    throw std::runtime_error("there is no output '" + std::string(output) + "'");
  }
};

/// One component, loaded from the plugins in WEFT_PLUGIN_PATH and called through the contract, as
/// by the host.
class PluginUnderTest {
 public:
  /// `params` is YAML: "{alpha_s: 0.2, warp: {use: warps/bbs}}"; input paths must be absolute.
  /// Throws std::runtime_error with the refusal.
  explicit PluginUnderTest(const std::string& id, const std::string& params = "{}",
                           std::uint64_t run_seed = 1);
  ~PluginUnderTest();

  Result<void> prepare(const Template& templ, const Camera& camera);
  PluginAnswer process(int method, const std::vector<Input>& inputs, std::uint64_t frame = 0);
  PluginAnswer evaluate(const Warp& warp, const Points& points);

  /// Set it from any thread to cancel the component.
  std::atomic<bool>& cancel();

  /// Sets a function that is called, from any thread, for each cancellation check of the component;
  /// true cancels. Null removes it.
  void watch(std::function<bool()> cancelled);

  /// From now on, each call has this time until its frame should be ready, see weft::Budget;
  /// negative where that is past. Without it there is no bound.
  void set_budget_ms(double budget_ms);

  /// Releases all answers so far, for tests of many frames.
  void forget();

 private:
  struct Host;
  std::unique_ptr<Host> host_;
};

}  // namespace weft::testing
