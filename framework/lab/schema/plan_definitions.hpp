// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/schema/key_schema.hpp"

namespace weft::schema {

/// Definitions of the parts of a plan, which refer to those of components:
///    axis, axis_value, data_entry   without required keys, for plans that extend another one
///    complete_axis                  the required keys of an axis in other plans
///    comparison, expectation        an entry of these lists
///    seeds, name, axis_name         seeds of data and runs, names that a plan gives
ordered_json plan_definitions();

/// The parts of plan_keys(), by these definitions.
Parts plan_parts();

}  // namespace weft::schema
