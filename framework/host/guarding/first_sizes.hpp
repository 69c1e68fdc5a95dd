// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstddef>
#include <cstdint>

namespace weft::host {

/// The flags that a host must not ignore.
inline constexpr std::uint32_t kMustBeKnown = 0xFFFF0000U;

/// [bytes] size of a struct of the contract in version 1.0. A host accepts this size from a library
/// even if the struct has grown since. Members behind it must be looked for in struct_size first.
template <class Struct>
inline constexpr std::size_t kFirstSize = 0;

template <>
inline constexpr std::size_t kFirstSize<weft_component> = 136;
template <>
inline constexpr std::size_t kFirstSize<weft_library_table> = 88;
template <>
inline constexpr std::size_t kFirstSize<weft_parameter> = 144;
template <>
inline constexpr std::size_t kFirstSize<weft_field> = 48;
template <>
inline constexpr std::size_t kFirstSize<weft_output> = 72;
template <>
inline constexpr std::size_t kFirstSize<weft_invocation> = 64;
template <>
inline constexpr std::size_t kFirstSize<weft_device_memory> = 32;
template <>
inline constexpr std::size_t kFirstSize<weft_devices> = 16;
template <>
inline constexpr std::size_t kFirstSize<weft_check> = 16;
template <>
inline constexpr std::size_t kFirstSize<weft_sweep> = 32;
template <>
inline constexpr std::size_t kFirstSize<weft_isolation> = 8;
template <>
inline constexpr std::size_t kFirstSize<weft_steering> = 24;

}  // namespace weft::host
