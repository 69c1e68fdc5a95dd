// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <weft/host/lane.hpp>

namespace weft::testing {

/// A noun as an input of a call; it copies the noun.
struct Input {
  std::string slot;
  std::shared_ptr<host::Record> record;
};

template <class Noun>
Input input(const char* slot, const Noun& noun) {
  auto record = host::Record::copy_of(noun);
  if constexpr (requires { noun.revision; }) record->set_revision(noun.revision);
  if constexpr (requires { noun.producer_handle; }) record->set_producer(noun.producer_handle);
  return {slot, std::move(record)};
}

/// What a call came to. Nouns got from it live as long as the PluginUnderTest.
struct Outcome {
  weft_status status = WEFT_OK;
  std::string message;
  std::string
      where;  ///< what an error is about, such as a file; the component where it says nothing
  std::vector<std::pair<std::string, host::RecordPtr>> outputs;

  /// The first output of this type, if there is one.
  template <class Noun>
  std::optional<Noun> get() const {
    for (const auto& [slot, record] : outputs) {
      if (record->type() != Noun::kType) continue;
      auto noun = host::view_as<Noun>(*record);
      if (noun) return *std::move(noun);
    }
    return std::nullopt;
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

 private:
  Outcome keep(host::Outcome outcome);

  host::Registry registry_;
  host::Lane lane_;
  std::optional<host::ComponentSpec> spec_;
  host::Instance* instance_ = nullptr;
  std::vector<host::RecordPtr> kept_;
};

}  // namespace weft::testing
