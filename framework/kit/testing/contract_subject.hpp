// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/role_contract.hpp>

#include "host/calling/execution_context.hpp"
#include "host/roles/role_rules.hpp"

namespace weft::testing {

/// A folder that is gone with this.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The component that is checked, with its parameters as the host resolves them.
class Subject {
 public:
  /// Fails with a sentence that names the missing parameter and how to give it.
  static Result<Subject> find(const host::Registry& registry, const std::string& id,
                              const std::string& params, const std::string& output_folder);
  static Result<Subject> find(const host::Registry& registry, const std::string& id,
                              const yaml::Node& params, const std::string& output_folder);

  /// The same component in other units: a pixel becomes `px` pixels, and a metre `m` metres. Scales
  /// parameters whose declared unit is pixels of the image or lengths in space, those of nested
  /// components too. Fails if one would leave its range.
  Result<Subject> in_units(double px, double m) const;

  const host::ComponentSpec& spec() const { return spec_; }
  const host::ComponentManifest& manifest() const { return spec_.component(); }
  const RoleRules& rules() const { return manifest().rules(); }
  /// True if it, or a component nested in it, uses the seed.
  bool is_random() const;
  bool is_exact() const { return manifest().determinism == "exact"; }

  /// True if the host delivers this input to its main method, and if the host requires it.
  bool takes(std::string_view slot) const;
  bool requires_input(std::string_view slot) const;
  bool produces(std::string_view output) const;

  /// Any warp that is installed, for components that read one.
  std::optional<host::ComponentSpec> warp_maker;
  /// The seed of its inputs.
  std::uint64_t seed = kContractSeed;

 private:
  Subject(const host::Registry& registry, host::ComponentSpec spec)
      : registry_(&registry), spec_(std::move(spec)) {}
  const host::Registry* registry_;
  host::ComponentSpec spec_;
};

/// The result of a call, with all device arrays downloaded.
struct Answer {
  weft_status status = WEFT_OK;
  Errc code = {};
  std::string message;
  std::vector<std::pair<std::string, HostRecord>> outputs{};  ///< [.] slot and record

  bool is_usable() const { return status == WEFT_OK || status == WEFT_DEGENERATE; }
  HostRecord find(std::string_view slot) const;

  template <class RecordType>
  std::optional<RecordType> get(std::string_view slot) const {
    const HostRecord record = find(slot);
    return record == nullptr ? std::nullopt : typed_in<RecordType>(record);
  }
};

/// "ok", "no_result (no keypoints)".
std::string to_text(const Answer& answer);

/// How two answers differ in any byte, "shape/vertices_m differs"; empty where they do not.
std::string difference(const Answer& a, const Answer& b);

/// Stands between the host and a component, and may change what the component is given.
class Passage {
 public:
  virtual ~Passage() = default;
  virtual std::int32_t create(const weft_component& component, const weft_create& with, void** self,
                              weft_error* error);
  virtual std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                               std::span<const weft_record> inputs, weft_error* error);
  virtual std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                               std::span<const weft_record> inputs, weft_error* error);
  virtual void destroy(const weft_component& component, void* self);
};

/// How an instance is made and called.
struct Performance {
  std::uint64_t run_seed = kContractSeed;              ///< [] seed of the run
  int threads = 1;                                     ///< that a call may use
  bool protects_inputs = true;                         ///< so that writing into them faults
  Passage* passage = nullptr;                          ///< null for none; outlives the instance
  std::shared_ptr<host::SharedArena> arena = nullptr;  ///< it lives in a worker, where there is one
};

/// An instance of the component in a separate execution context.
class Performer {
 public:
  explicit Performer(const Subject& subject, const Performance& how = {});
  ~Performer();

  /// Creates it, and prepares it unless it is a source or a template.
  Result<void> begin(const Template& templ, const Camera& camera);

  /// The parts of the above, for what is created and not prepared, or prepared twice.
  Result<void> create();
  Result<void> prepare(const Template& templ, const Camera& camera);

  /// Puts an instance with other parameters in its place, as a run does when one is set.
  Result<void> replace(const Subject& changed, const Template& templ, const Camera& camera);

  Answer call(int method, const std::vector<Input>& inputs, std::uint64_t frame = 0);
  Answer evaluate(const HostRecord& warp, const Points& points);

  std::atomic<bool>& cancel() { return context_.cancellation().flag(); }
  void watch(std::function<bool()> cancelled) {
    context_.cancellation().watch(std::move(cancelled));
  }

 private:
  struct Passed;
  Result<host::Instance*> made(const Subject& subject);

  const Subject* subject_;
  Performance how_;
  std::vector<std::unique_ptr<Passed>> passed_;  ///< behind the instances of the execution context
  host::ExecutionContext context_;
  host::Instance* instance_ = nullptr;
  host::Instance* warp_maker_ = nullptr;
};

}  // namespace weft::testing
