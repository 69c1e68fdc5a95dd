// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/loading/registry.hpp"
#include "lab/schema/key_schema.hpp"

namespace weft::schema {

/// Definitions of all legal entries at the places of components in a pipeline:
///    source, template, stage, sink   one entry, without required keys
///    stages, sinks                   a list of these
///    complete, complete_stage        the required keys of an entry that overrides no other one
///    nested_ROLE                     a component that is the value of a parameter
///    params_ROLE                     `params` by `use`
///    ROLE.NAME                       the parameters of one plugin
///    from, when, names               as in the keys of a stage
ordered_json component_definitions(const host::Registry& registry);

/// The parts of pipeline_keys(), by these definitions.
Parts pipeline_parts();

}  // namespace weft::schema
