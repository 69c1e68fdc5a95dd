// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <weft/core/index.hpp>
#include <weft/sdk/export.hpp>

/// Arrays that stay on a device. A library says once what it keeps there:
///
///   class Rows {  // of a device's memory
///    public:
///     // In C order. Waits until they are there; Errc::cancelled if told to stop before.
///     Result<void> download(std::span<std::byte> to, const std::function<bool()>& cancelled)
///     const;
///   };
///
/// Any thread may call download(), or destroy the object with its last reference, also when no
/// component is left. A maker may answer before the work is done: who reads the array where it lies
/// waits by what the class holds for it, such as an event.
///
/// Every component that makes or reads such arrays names the class, `About{...,
/// .device_memory = &weft::kDeviceMemory<Rows>}`; it must be the same class in the whole library,
/// so outside of unnamed namespaces. An array made with on_device() goes into a field of the
/// catalogue that may be on a device, and its reader asks device_contents(). Everyone else is given
/// a copy in host memory by the host. A component may also list what it could compute on, for
/// `weft doctor`: `static std::vector<std::string> devices()`.
namespace weft {

namespace detail {

/// What a handle stands for: its references and the contents.
template <class Memory>
struct DeviceBlock {
  std::shared_ptr<const Memory> contents;
  std::atomic<int> references{1};

  static DeviceBlock* of(std::uint64_t handle) { return std::bit_cast<DeviceBlock*>(handle); }
  std::uint64_t handle() const { return std::bit_cast<std::uint64_t>(this); }

  static void retain(std::uint64_t handle) { ++of(handle)->references; }
  static void release(std::uint64_t handle) {
    if (--of(handle)->references == 0) std::unique_ptr<DeviceBlock>(of(handle)).reset();
  }
  static std::int32_t download(const weft_call* call, std::uint64_t handle, void* to,
                               std::uint64_t bytes, weft_error* error) {
    return guarded(error, [&]() -> std::int32_t {
      const auto done = of(handle)->contents->download(
          {static_cast<std::byte*>(to), to_index(bytes)},
          [call] { return call != nullptr && call->host->cancelled(call) != 0; });
      return done ? WEFT_OK : report(done.error(), error);
    });
  }
};

}  // namespace detail

/// The contract's functions for arrays whose contents are a Memory.
template <class Memory>
inline constexpr weft_device_memory kDeviceMemory{
    sizeof(weft_device_memory), 0, &detail::DeviceBlock<Memory>::retain,
    &detail::DeviceBlock<Memory>::release, &detail::DeviceBlock<Memory>::download};

/// An array of T whose contents lie on a device. `download` writes elements of T, whatever the
/// device holds. Throws std::length_error for more than six axes.
template <class T, class Memory>
Array<T> on_device(std::shared_ptr<const Memory> contents,
                   std::initializer_list<std::int64_t> lengths) {
  typename Array<T>::Shape shape{};
  if (lengths.size() > shape.size()) throw std::length_error("an array has at most six axes");
  std::copy(lengths.begin(), lengths.end(), shape.begin());
  using Block = detail::DeviceBlock<Memory>;
  auto block = std::make_unique<Block>();
  block->contents = std::move(contents);
  const std::uint64_t handle = block->handle();
  const std::shared_ptr<void> owner(block.release(), [handle](void*) { Block::release(handle); });
  return Array<T>::on_device(handle, static_cast<int>(lengths.size()), shape, owner);
}

/// What on_device() was given; null for an array in host memory. Of inputs, and of what nested
/// components answer: the host has seen to it that what lies on a device was made with this Memory.
template <class Memory, class T>
std::shared_ptr<const Memory> device_contents(const Array<T>& array) {
  if (!array.is_on_device()) return nullptr;
  return detail::DeviceBlock<Memory>::of(array.handle())->contents;
}

}  // namespace weft
