// SPDX-License-Identifier: Apache-2.0
// The parts of weft_abi_host. All print to standard output.
#pragma once

#include <string>

#include "host/loading/registry.hpp"

namespace weft::abi_test {

/// Prints the declarations of a component, as its manifest has them.
void print_manifest(const host::ComponentManifest& component);

/// Prints the answers of each extension of a component with these parameters.
void print_extensions(const host::Registry& registry, const std::string& id,
                      const std::string& params);

/// Prints the catalogue of records: a line for each array.
void print_catalogue();

}  // namespace weft::abi_test
