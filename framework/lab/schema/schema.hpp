// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "host/loading/registry.hpp"

namespace weft::schema {

// JSON Schemas (draft 2020-12) as text, made of the tables of keys that the readers use and of the
// manifests of what is installed. They refuse nothing that a reader takes, but for odd spellings
// such as a text that looks like null; a reader sees more: files, names of stages, the wiring.

/// Schema of pipeline files.
std::string pipeline_schema(const host::Registry& registry);

/// Schema of the plans of ablations.
std::string plan_schema(const host::Registry& registry);

}  // namespace weft::schema
