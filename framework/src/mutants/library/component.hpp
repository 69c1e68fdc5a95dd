// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mutants/library/deeds.hpp"

namespace weft::mutants {

// The functions of a component, in front of the plugin's own.
std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                     const Inputs& inputs, weft_error& error);
std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                     Inputs inputs, weft_error& error);
void destroy(const weft_component& component, void* self);
const void* get_extension(const weft_component& component, const char* name);

}  // namespace weft::mutants
