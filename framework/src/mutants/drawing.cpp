// SPDX-License-Identifier: Apache-2.0
#include "mutants/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <weft/core/rng.hpp>

namespace weft::mutants {
namespace {

bool is_number(const host::ParameterSpec& parameter) {
  const bool has_type = parameter.type == WEFT_VALUE_F64 || parameter.type == WEFT_VALUE_I64;
  return has_type && !parameter.is_vector;
}

bool has(Having what, const host::ComponentManifest& component) {
  const auto& parameters = component.parameters;
  switch (what) {
    case Having::anything:
      return true;
    case Having::numbers:
      return std::any_of(parameters.begin(), parameters.end(), is_number);
    case Having::ranges:
      return std::any_of(parameters.begin(), parameters.end(), [](const auto& parameter) {
        return is_number(parameter) && parameter.bounded;
      });
    case Having::extension:
      return !component.extensions.empty();
    case Having::no_random:
      return !component.random;
  }
  return false;
}

/// Whether it can be checked as it is installed; parameters stand in a file beside the library.
bool is_usable(const host::ComponentManifest& component, const std::string& library) {
  const auto& parameters = component.parameters;
  const bool needs_values = std::any_of(parameters.begin(), parameters.end(),
                                        [](const auto& parameter) { return parameter.required; });
  const auto values = std::filesystem::path(library).replace_extension(".check");
  std::error_code none;
  const auto bytes = std::filesystem::file_size(values, none);
  const bool has_values = !none && bytes > 1;  // more than a line that says nothing
  return component.unknown.empty() && !component.prefers_isolation() &&
         !component.keeps_arrays_on_devices() && (!needs_values || has_values);
}

std::vector<std::string> manifests_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string file = entry.path().string();
    if (file.ends_with(".plugin.yaml")) files.push_back(file);
  }
  return files;
}

std::vector<Mutant> pairs_of(const Operator& change, std::span<const Original> originals) {
  std::vector<Mutant> pairs;
  for (const Original& original : originals) {
    if (applies(change, original.component)) pairs.push_back({&change, &original});
  }
  return pairs;
}

}  // namespace

Result<std::vector<Original>> originals_in(const std::string& folder,
                                           const std::vector<std::string>& ids) {
  std::vector<Original> originals;
  for (const std::string& file : manifests_in(folder)) {
    auto manifest = host::read_manifest(file);
    if (!manifest || manifest->components.size() != 1) continue;
    host::ComponentManifest& component = manifest->components.front();
    const bool is_wanted =
        ids.empty() || std::find(ids.begin(), ids.end(), component.id) != ids.end();
    if (is_wanted && is_usable(component, manifest->library)) {
      originals.push_back({file, manifest->library, std::move(component)});
    }
  }
  std::sort(originals.begin(), originals.end(),
            [](const Original& a, const Original& b) { return a.component.id < b.component.id; });
  for (const std::string& id : ids) {
    const bool is_there =
        std::any_of(originals.begin(), originals.end(),
                    [&](const Original& each) { return each.component.id == id; });
    if (is_there) continue;
    return Error{Errc::not_found,
                 "there is no library whose one component is '" + id +
                     "' and can be checked without parameters, devices and interpreters",
                 folder};
  }
  return originals;
}

bool applies(const Operator& change, const host::ComponentManifest& component) {
  std::istringstream roles{std::string(change.roles)};
  bool fits = change.roles.empty();
  for (std::string role; roles >> role;) fits = fits || role == component.role();
  return fits && has(change.having, component);
}

std::string Mutant::name() const {
  std::string id = original->component.id;
  std::replace(id.begin(), id.end(), '/', '_');
  return std::string(change != nullptr ? change->name : "none") + "." + id;
}

Drawn draw(std::span<const Original> originals, std::uint64_t seed, std::size_t count) {
  Rng rng(seed);
  Drawn drawn;
  std::vector<Mutant> others;
  for (const Operator& change : operators()) {
    std::vector<Mutant> pairs = pairs_of(change, originals);
    if (pairs.empty()) {
      drawn.unused.push_back(&change);
      continue;
    }
    rng.shuffle(pairs);
    drawn.mutants.push_back(pairs.back());
    others.insert(others.end(), pairs.begin(), pairs.end() - 1);
  }
  rng.shuffle(others);
  const std::size_t wanted = count - std::min(count, drawn.mutants.size());
  others.resize(std::min(wanted, others.size()));
  drawn.mutants.insert(drawn.mutants.end(), others.begin(), others.end());
  std::stable_sort(drawn.mutants.begin(), drawn.mutants.end(),
                   [](const Mutant& a, const Mutant& b) { return a.change < b.change; });
  return drawn;
}

}  // namespace weft::mutants
