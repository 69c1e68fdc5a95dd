// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lab/ablation/plan/cell_identity.hpp"

/// The cells of a grid consist of few parts: some data, some pipelines, all combinations. Each part
/// is read, checked and identified only once.
namespace weft::lab {

/// The content of a document in two parts, each with the texts that contain its values. One part is
/// source and template. The other is the rest, with the components of the first, on which the
/// wiring depends.
struct PartNames {
  std::string data, rest;
};
PartNames part_names(const yaml::Node& root);

/// Known facts about a pipeline without errors, for all its run seeds.
struct KnownPipeline {
  std::vector<std::string> stages, filters;  ///< names
  std::vector<std::uint64_t> seeds;          ///< [.] run seeds
  std::vector<CellIdentity> identities;      ///< one a seed, without the keys of stages
};

/// Parts of pipelines without errors.
class KnownParts {
 public:
  /// Nothing where a part of it is not known.
  std::optional<KnownPipeline> find(const PartNames& names,
                                    const std::vector<std::uint64_t>& seeds) const;

  /// Notes the parts of a pipeline; errors that only its files show go to `problems`.
  void note(const PartNames& names, const CheckedPipeline& pipeline,
            const std::vector<std::uint64_t>& seeds, const Measurement& measurement,
            Identifier& identifier, std::vector<yaml::Problem>& problems);

 private:
  using Texts = std::map<std::uint64_t, IdentityPart>;  ///< by run seed; by 0 where it has none
  struct Rest {
    std::vector<std::string> stages, filters;  ///< [.] names
    std::uint64_t own_seed = 0;                ///< [] seed of the pipeline file
    Texts texts;
  };
  static const IdentityPart* text_for(const Texts& texts, std::uint64_t seed);

  std::map<std::string, Texts> data_;
  std::map<std::string, Rest> rests_;
};

}  // namespace weft::lab
