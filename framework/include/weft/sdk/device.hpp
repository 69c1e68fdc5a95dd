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

/// Arrays that stay on a device. A library defines one class for their contents:
///
///   class Rows {  // memory of a device
///    public:
///     // In C order. Waits for the contents; returns Errc::cancelled on cancellation.
///     Result<void> download(std::span<std::byte> to, const std::function<bool()>& cancelled)
///     const;
///   };
///
/// Any thread may call download() or destroy the object with its last reference, even when no
/// component is left. A producer may return before the device has finished. A reader on the device
/// waits through the object, for example through an event that it contains.
///
/// Every component that makes or reads such arrays declares the class, `About{...,
/// .device_memory = &weft::kDeviceMemory<Rows>}`. The whole library must use the same class,
/// outside of unnamed namespaces. on_device() makes the array for a catalogue field that may be on
/// a device; readers call device_contents(). The host gives all other components a copy in host
/// memory. A component may also list its devices for `weft doctor`:
/// `static std::vector<std::string> devices()`.
namespace weft {

namespace detail {

/// The object behind a handle: a reference count and the contents.
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

/// Makes an array of T whose contents are on a device. `download` writes elements of T, whatever
/// the device stores. Throws std::length_error for more than six axes.
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

/// Returns the object given to on_device(); null for an array in host memory. Valid for inputs and
/// for answers of nested components. The host guarantees that arrays on a device were made with
/// this Memory.
template <class Memory, class T>
std::shared_ptr<const Memory> device_contents(const Array<T>& array) {
  if (!array.is_on_device()) return nullptr;
  return detail::DeviceBlock<Memory>::of(array.handle())->contents;
}

}  // namespace weft
