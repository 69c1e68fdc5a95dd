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
#include <weft/host/lane.hpp>

namespace weft::testing {

/// A noun as an input of a call; it copies the noun.
struct Input {
  std::string slot;
  host::RecordPtr record;
};

template <class Noun>
Input input(const char* slot, const Noun& noun) {
  auto record = host::Record::copy_of(noun);
  if constexpr (requires { noun.revision; }) record->set_revision(noun.revision);
  if constexpr (requires { noun.producer_handle; }) record->set_producer(noun.producer_handle);
  return {slot, std::move(record)};
}

/// What a call came to. Nouns got from it live as long as the PluginUnderTest, or until it forgets.
struct Outcome {
  weft_status status = WEFT_OK;
  Errc code = {};  ///< unless all is well
  std::string message;
  std::string
      where;  ///< what an error is about, such as a file; the component where it says nothing
  std::vector<std::pair<std::string, host::RecordPtr>> outputs;

  /// The first output of this type, if there is one.
  template <class Noun>
  std::optional<Noun> get() const {
    for (const auto& [slot, record] : outputs) {
      if (record->type() != Noun::kType) continue;
      const auto here = record->in_host_memory();
      if (!here) continue;
      auto noun = host::view_as<Noun>(**here);
      if (noun) return *std::move(noun);
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

/// One component, loaded and called as the host does: through the contract, from the plugins in
/// WEFT_PLUGIN_PATH.
class PluginUnderTest {
 public:
  /// `params` as YAML: "{alpha_s: 0.2, warp: {use: warps/bbs}}"; input paths must be absolute.
  /// Throws std::runtime_error with the refusal.
  explicit PluginUnderTest(const std::string& id, const std::string& params = "{}",
                           std::uint64_t run_seed = 1);
  ~PluginUnderTest();

  Result<void> prepare(const Template& templ, const Camera& camera);
  Outcome process(int method, const std::vector<Input>& inputs, std::uint64_t frame = 0);
  Outcome evaluate(const Warp& warp, const Points& points);

  /// Set from any thread to make the component stop.
  std::atomic<bool>& cancel() { return lane_.cancel(); }

  /// Asked as often as the component asks whether to stop; see host::Lane.
  void watch(std::function<bool()> cancelled) { lane_.watch(std::move(cancelled)); }

  /// Lets go of all answers so far, for tests of many frames.
  void forget();

 private:
  Outcome keep(host::Outcome outcome);

  host::Registry registry_;
  host::Lane lane_;
  std::optional<host::ComponentSpec> spec_;
  host::Instance* instance_ = nullptr;
  std::vector<host::RecordPtr> kept_;
};

}  // namespace weft::testing
