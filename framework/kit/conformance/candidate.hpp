// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/loading/registry.hpp"
#include "kit/testing/contract_subject.hpp"

namespace weft::conformance {

/// A component that is to be checked, and what it is checked with.
struct Candidate {
  std::string id;  ///< for a library that cannot be used, its file
  std::shared_ptr<const host::Registry> registry;
  std::string params = "{}";            ///< YAML
  std::vector<std::string> deviations;  ///< checks that fail according to its page
  bool geometry = false;                ///< true if the laws of geometry are among its checks
  std::string skipped;                  ///< why it cannot be checked here; empty where it can
  std::string refusal;                  ///< why its library cannot be used, and the fix
  std::uint64_t seed = testing::kContractSeed;  ///< seed of all random numbers

  /// Null where the library is refused.
  const host::Installed* installed() const { return registry->find(id); }

  /// With its parameters, or with others.
  Result<testing::Subject> find(const std::string& output_folder,
                                const yaml::Node* params = nullptr) const;
};

/// The request of the command line.
struct Asked {
  std::vector<std::string> subjects;            ///< libraries, manifests, ids
  bool all = false;                             ///< every installed component
  std::string params;                           ///< YAML, of a single component; empty for none
  std::vector<std::string> plugin_folders;      ///< [.] searched first
  std::uint64_t seed = testing::kContractSeed;  ///< [] seed of the synthetic inputs
};

/// Parameters, deviations and reasons to skip are read of the file `<library>.check` beside the
/// manifest, where weft_add_plugin has left what is given to it behind CONTRACT. Fails with io
/// where a file is not there, with not_found and invalid_value where something else is wrong.
Result<std::vector<Candidate>> candidates(const Asked& asked);

}  // namespace weft::conformance
