// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace weft::testing {

/// How a component did.
struct ContractReport {
  int checks = 0;                         ///< [] that were made
  std::vector<std::string> failures;      ///< "with 0 matches: says ok and keeps no match"
  std::vector<std::string> deviations;    ///< the same, of checks that may fail
  std::vector<std::string> inapplicable;  ///< checks that say nothing of it: "image scaled: why"
  std::string skipped;                    ///< why nothing was checked; empty where it was
};

/// What a component is checked with.
struct ContractOptions {
  std::string params = "{}";                 ///< YAML; paths are relative to the working directory
  std::vector<std::string> deviations = {};  ///< checks that may fail: "with 0 matches"
  std::vector<std::string> plugin_folders = {};  ///< searched before those of WEFT_PLUGIN_PATH
  bool geometry = false;  ///< also that answers follow scenes that move, and exact matches
  std::function<void(const std::string& what)> watch = {};  ///< told before each check what it is
};

/// All synthetic inputs of the contract are drawn from it.
inline constexpr int kContractSeed = 1;

/// Calls one component as the host does, and checks what it owes whoever calls it: its manifest,
/// usual and degenerate inputs, the same answer fresh and warm, cancelling, and what its role
/// promises of outputs. Failures are in the report, those of finding the component too.
ContractReport check_role_contract(const std::string& id, const ContractOptions& options = {});

/// Inputs of the contract can only be read, and only while a call runs. Says what a component did
/// to one that faulted at an address, "wrote into its input " or "went beyond the end of its input
/// ", and which it was, "correspondences/kept"; nulls where that is no input. For handlers of
/// signals.
struct SpoiltInput {
  const char *deed, *input;
};
SpoiltInput spoilt_input_at(const void* address);

/// Ids of the components in a manifest. Throws std::runtime_error where it cannot be read.
std::vector<std::string> components_in(const std::string& manifest_file);

}  // namespace weft::testing
