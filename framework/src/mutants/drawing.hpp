// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "host/loading/manifest.hpp"
#include "mutants/operators.hpp"

namespace weft::mutants {

/// A component that mutants are made of; its library holds no other.
struct Original {
  std::string manifest, library;  ///< files
  host::ComponentManifest component;
};

/// What can be checked without a device or an interpreter, and without parameters unless these
/// stand beside the library, in a file .check: of the libraries in a folder, those with one such
/// component, in the order of their ids. `ids` keeps only these, where
/// it is not empty. Fails with not_found where one of them is not among them.
Result<std::vector<Original>> originals_in(const std::string& folder,
                                           const std::vector<std::string>& ids = {});

bool applies(const Operator& change, const host::ComponentManifest& component);

struct Mutant {
  const Operator* change;  ///< null: it behaves as the original
  const Original* original;

  std::string name() const;  ///< "nan_in_output.filters_gms"
};

struct Drawn {
  std::vector<Mutant> mutants;          ///< by operator, in the order of the list
  std::vector<const Operator*> unused;  ///< those that apply to none of the originals
};

/// One mutant of each operator, then others, all different, until there are `count` or no pair is
/// left. The same seed and the same originals give the same ones.
Drawn draw(std::span<const Original> originals, std::uint64_t seed, std::size_t count);

}  // namespace weft::mutants
