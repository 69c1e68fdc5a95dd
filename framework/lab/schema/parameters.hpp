// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "host/loading/manifest.hpp"
#include "lab/schema/key_schema.hpp"

namespace weft::schema {

/// The `params` of a component: each parameter with its help and unit, type, range or choices, and
/// default, as the manifest has them.
ordered_json parameters_schema(const host::ComponentManifest& component);

}  // namespace weft::schema
