// SPDX-License-Identifier: Apache-2.0
// A library against the bare contract that makes the one mistake which WEFT_ZOO_ANIMAL names.
#pragma once

#include <weft/abi.h>

#include <string_view>

namespace zoo {

/// Whether this is the mistake.
bool is(std::string_view mistake);

void write_where_nothing_is();
[[noreturn]] void sleep_for_ever();

/// While the library is loaded.
void act_when_loaded();

/// Makes mistakes in the library's table and in that of its one component.
void spoil(weft_library_table& table, weft_component& component);

std::int32_t describe(const weft_describe* sink, weft_error* error);
std::int32_t create(const weft_create* with, void** self, weft_error* error);
std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error);
std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error);
void destroy(void* self);
const void* get_extension(const char* name);

}  // namespace zoo
