// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace weft::testing {

/// Results of a contract check.
struct ContractReport {
  int checks = 0;  ///< [] number of checks
  std::vector<std::string>
      failures;  ///< failures, such as "with 0 matches: reports ok without evidence"
  std::vector<std::string> deviations;    ///< failures of checks that are allowed to fail
  std::vector<std::string> inapplicable;  ///< checks that do not apply: "image scaled: why"
  std::string skipped;                    ///< reason why nothing was checked; empty otherwise
};

/// Options of a contract check.
struct ContractOptions {
  std::string params = "{}";                 ///< YAML; paths are relative to the working directory
  std::vector<std::string> deviations = {};  ///< checks that are allowed to fail: "with 0 matches"
  std::vector<std::string> plugin_folders =
      {};                 ///< folders searched before those of WEFT_PLUGIN_PATH
  bool geometry = false;  ///< also checks that answers follow moving scenes and exact matches
  std::function<void(const std::string& what)> watch =
      {};  ///< called before each check with its name
};

/// Seed of all synthetic inputs of the contract check.
inline constexpr int kContractSeed = 1;

/// Calls one component as the host does and checks its manifest and its answers to usual and
/// degenerate inputs. It also checks that fresh and warm instances answer alike, cancellation, and
/// the output guarantees of the role. Failures are in the report, including a component that cannot
/// be found.
ContractReport check_role_contract(const std::string& id, const ContractOptions& options = {});

/// Describes an illegal access to an input of a contract check, for signal handlers. Inputs are
/// read-only and valid only during a call. `deed` is "wrote into its input " or "went beyond the
/// end of its input "; `input` is the input, such as "correspondences/kept". Both are null if the
/// address is not in an input.
struct SpoiltInput {
  const char *access, *input;
};
SpoiltInput spoilt_input_at(const void* address);

/// Ids of the components in a manifest. Throws std::runtime_error if it cannot be read.
std::vector<std::string> components_in(const std::string& manifest_file);

}  // namespace weft::testing
