// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace weft::host {

/// The flags of the first processor in /proc/cpuinfo; empty where the kernel lists none.
std::string kernel_flags();

/// Instruction sets that plugins may use, by the names that manifests use: "avx2", "fma". The
/// processor has them (CPUID), the system saves their registers (XCR0), and the kernel lists them
/// in `flags`. Hypervisors and boot options mask CPUID and the kernel's list separately; a feature
/// that one of them hides may be emulated, faulty or gone after a migration. Empty flags, and
/// features that Linux 6.1 does not list, leave the decision to CPUID.
std::vector<std::string> processor_features(std::string_view flags = kernel_flags());

/// True if plugins may use this feature; false for an unknown name.
bool processor_has(std::string_view feature);

/// True for the name of a feature that this or another processor may have.
bool is_processor_feature(std::string_view name);

/// The processor's name for itself; "unknown" if the system does not report it.
std::string processor_name();

}  // namespace weft::host
