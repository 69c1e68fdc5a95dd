// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

#include "host/records/record_schema.hpp"
#include "host/roles/role_rules.hpp"
#include "yaml/yaml.hpp"

namespace weft::host {

/// One parameter as its component declares it.
struct ParameterSpec {
  std::string name;
  weft_value_type type = WEFT_VALUE_F64;
  bool is_vector = false;
  bool required = false;
  yaml::Node default_value;
  std::string unit;
  std::string help;
  bool bounded = false;
  double minimum = 0.0;  ///< in `unit`, inclusive; of an integer the nearest double
  double maximum = 0.0;  ///< in `unit`, inclusive; of an integer the nearest double
  std::int64_t integer_minimum = std::numeric_limits<std::int64_t>::min();  ///< integers: in `unit`
  std::int64_t integer_maximum = std::numeric_limits<std::int64_t>::max();  ///< integers: in `unit`
  std::vector<std::string> choices;  ///< for an input path: words that are legal instead of a path
  std::string role;                  ///< role of a component parameter
  std::string was;                   ///< its name in older versions, or empty
  bool is_deprecated = false;        ///< its help names what to use instead
  bool is_prominent = false;         ///< one of those that users change most

  /// True if the value of an input path names a file or files.
  bool names_files(const std::string& value) const {
    return type == WEFT_VALUE_INPUT_PATH && !value.empty() &&
           std::find(choices.begin(), choices.end(), value) == choices.end();
  }
};

/// The parameter that decides how strict a component is, and values over which a ROC curve runs.
struct SweepSpec {
  std::string parameter;
  std::vector<double> values;  ///< ascending
};

/// One component as its library's manifest describes it.
struct ComponentManifest {
  std::string id, version, summary, reference, licence, determinism;
  std::string implements;  ///< "paper", "reconstruction" or "own"; empty where it is not stated
  std::vector<std::string> needs, reads, produces;  ///< [.] names of slots
  std::vector<std::string> records;  ///< types that it may read or make, "correspondences/1"
  bool random = false;
  bool uses_truth = false;
  std::vector<std::string> extensions;                    ///< "weft.devices/1"
  std::vector<ParameterSpec> parameters;                  ///< [.] in the order of declaration
  std::optional<SweepSpec> sweep;                         ///< values of a ROC curve, if declared
  std::vector<RecordSchema> record_types;                 ///< record types of vendors among
                                                          ///< `records`
  std::shared_ptr<const RoleRules> open_rules = nullptr;  ///< its own, where its role is open
  std::string unknown;  ///< features that this version of Weft does not support, in words, or empty

  /// How the host treats its role, with the component's own slots if the role leaves them open.
  const RoleRules& rules() const { return open_rules != nullptr ? *open_rules : rules_of(role()); }
  const RecordSchema* schema_of(std::string_view type) const;
  /// Derives `open_rules` from the component's declarations, or explains in `unknown` why they are
  /// illegal.
  void find_rules();
  std::string role() const { return id.substr(0, id.find('/')); }
  bool has_extension(std::string_view name) const {
    return std::find(extensions.begin(), extensions.end(), name) != extensions.end();
  }
  bool prefers_isolation() const { return has_extension(WEFT_ISOLATION); }
  bool keeps_arrays_on_devices() const { return has_extension(WEFT_DEVICES); }
  bool steers_runs() const { return has_extension(WEFT_STEERING); }
};

/// The description of a library, stored beside it and readable without loading it.
struct Manifest {
  std::string file;     ///< path of the manifest
  std::string library;  ///< shared object beside the manifest
  int abi_major = 0;    ///< [] WEFT_ABI_MAJOR of its build
  int abi_minor = 0;    ///< minor version of the header with which it was built
  int needs_minor = 0;  ///< the oldest host that it works with
  std::string build_id, compiler;
  std::vector<std::string> isa;               ///< [.] required processor features
  std::vector<ComponentManifest> components;  ///< [.] components of the library
};

/// Fails with syntax or invalid_data, at file:line:column.
Result<Manifest> read_manifest(const std::string& file);

/// The word that a manifest uses for a parameter's type: "f64", "choice".
const char* parameter_type_name(weft_value_type type);

}  // namespace weft::host
