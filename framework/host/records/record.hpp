// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <weft/core/name.hpp>
#include <weft/data/codec.hpp>

#include "host/records/device_array.hpp"
#include "host/records/memory_pool.hpp"
#include "host/records/record_schema.hpp"
#include "host/records/shared_memory.hpp"

namespace weft::host {

/// A record that the host owns: what a plugin allocated through the host, or a copy of a record
/// struct.
class Record {
 public:
  /// Its storage is allocated in `pool`, and its arrays in `arena`, if these are given.
  explicit Record(std::string_view type, std::shared_ptr<SharedArena> arena = nullptr,
                  std::shared_ptr<MemoryPool> pool = nullptr);
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  /// A record whose own object is stored in the pool too.
  static std::shared_ptr<Record> make(std::string_view type,
                                      const std::shared_ptr<MemoryPool>& pool = nullptr,
                                      const std::shared_ptr<SharedArena>& arena = nullptr) {
    return std::allocate_shared<Record>(PoolAllocator<Record>(pool), type, arena, pool);
  }

  /// Not cleared, see mark_unwritten(); 64-byte aligned, C order; replaces an array of the same
  /// name. Null when the request is illegal or memory is short. Names have letters, digits, `_`,
  /// `-` and `.` only.
  void* allocate(std::string_view name, std::int32_t dtype, std::int32_t ndim,
                 const std::int64_t* shape);

  /// An array whose contents are there already, contiguous in C order, in memory that another
  /// process maps too. False when the request is illegal.
  bool adopt(std::string_view name, std::int32_t dtype, std::int32_t ndim,
             const std::int64_t* shape, std::shared_ptr<void> contents);

  /// An array that stays in the device memory of its maker's library. False when the request is
  /// illegal.
  bool adopt(std::string_view name, std::int32_t dtype, std::int32_t ndim,
             const std::int64_t* shape, const weft_device_memory& library, std::uint64_t handle,
             const std::string& maker);

  /// Ends with NUL.
  std::string_view type() const { return schema_ != nullptr ? schema_->type : own_type_; }
  /// The catalogue's schema of its type; null for a type of a vendor.
  const RecordSchema* schema() const { return schema_; }
  std::uint64_t revision() const { return revision_; }
  void set_revision(std::uint64_t revision) { revision_ = revision; }
  void set_producer(std::uint64_t component) { producer_ = component; }
  std::int64_t frame() const { return frame_; }
  /// The frame in which it was made, or WEFT_NO_FRAME.
  void set_frame(std::int64_t frame) { frame_ = frame; }

  /// Bytes of the arrays that others have replaced. Their maker may still write them, so that they
  /// are kept until forget_replaced().
  std::int64_t replaced_bytes() const { return replaced_bytes_; }
  void forget_replaced() {
    replaced_.clear();
    replaced_bytes_ = 0;
  }

  /// The arrays as the contract sees them, valid while this record lives and is not changed.
  weft_record view(const char* slot) const;

  /// A copy of the array's entry, sharing its memory, from another record.
  void share(const Record& other, std::string_view name);

  /// A record of the same content that shares all arrays with this one.
  std::shared_ptr<const Record> alias() const;

  /// As alias(), with copies of what lies in device memory. Fails as DeviceArray::copy().
  Result<std::shared_ptr<const Record>> in_host_memory() const;

  template <class RecordType>
  static std::shared_ptr<Record> copy_of(const RecordType& typed,
                                         const std::shared_ptr<MemoryPool>& pool = nullptr) {
    auto record = make(RecordType::kType, pool);
    const auto allocate = [&](const char* name, std::int32_t dtype, int ndim,
                              const std::int64_t* shape) {
      return record->allocate(name, dtype, ndim, shape);
    };
    if (!write_record(typed, allocate)) return nullptr;
    return record;
  }

 private:
  struct Entry {
    Name name;
    std::shared_ptr<void> memory;
  };
  std::size_t slot_of(std::string_view name);
  weft_array& place(std::string_view name, std::int32_t dtype, std::int32_t ndim,
                    const std::int64_t* shape, std::shared_ptr<void> contents, weft_memory kind);

  const RecordSchema* schema_;
  std::string own_type_;  ///< where the catalogue has no such type
  std::shared_ptr<MemoryPool> pool_;
  std::shared_ptr<SharedArena> arena_;
  std::uint64_t revision_ = 0;
  std::uint64_t producer_ = 0;
  std::int64_t frame_ = WEFT_NO_FRAME;
  PooledVector<Entry> entries_;
  PooledVector<weft_array> arrays_;
  PooledVector<std::shared_ptr<void>> replaced_;
  std::int64_t replaced_bytes_ = 0;
};

using RecordPtr = std::shared_ptr<const Record>;

/// Records by slot, as one file or one call has them.
using NamedRecords = PooledVector<std::pair<std::string, RecordPtr>>;

/// True if no number of an array, which is not in device memory, is NaN or infinite.
bool is_finite(const weft_array& array);

/// The entry of an array that lies contiguous in C order.
weft_array array_at(const char* name, std::int32_t dtype, std::int32_t ndim,
                    const std::int64_t* shape, void* data, weft_memory kind);

/// True if a name is legal in files and reports.
bool is_legal_name(std::string_view name);

/// [bytes] of an array, or -1 when its type or shape is illegal.
std::int64_t array_bytes(std::int32_t dtype, std::int32_t ndim, const std::int64_t* shape);

/// The struct of a record, borrowing from it. The record was validated when it was made.
template <class RecordType>
Result<RecordType> view_as(const Record& record) {
  return read_record<RecordType>(record.view(""));
}

/// The same without its texts and the arrays that the catalogue does not name: allocates nothing.
template <class RecordType>
Result<RecordType> arrays_of(const Record& record) {
  return read_arrays<RecordType>(record.view(""));
}

/// Checks that an output of a call is as long as the inputs to which it refers. A mask refers to
/// its matches, samples of a warp to the points, a shape and its visibility to the template's mesh.
Result<void> check_lengths(const weft_record& output, std::span<const weft_record> inputs);

}  // namespace weft::host
