// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <weft/data/codec.hpp>

namespace weft::host {
class Record;
}

namespace weft::testing {

/// A record as the host holds it.
using HeldRecord = std::shared_ptr<const host::Record>;

/// Builds one, array by array.
class RecordMaker {
 public:
  explicit RecordMaker(const char* type);

  /// Not cleared, C order; null when the request is illegal.
  void* operator()(const char* name, std::int32_t dtype, int ndim, const std::int64_t* shape);

  void set_revision(std::uint64_t revision);
  void set_producer(std::uint64_t handle);
  HeldRecord finish() { return std::move(record_); }

 private:
  std::shared_ptr<host::Record> record_;
};

/// A copy of a record struct; null where it is no legal record.
template <class RecordType>
HeldRecord hold(const RecordType& typed) {
  RecordMaker maker(RecordType::kType);
  if (!write_record(typed, maker)) return nullptr;
  if constexpr (requires { typed.revision; }) maker.set_revision(typed.revision);
  if constexpr (requires { typed.producer_handle; }) maker.set_producer(typed.producer_handle);
  return maker.finish();
}

/// The record with all that lies on a device fetched; null where it is of another type.
HeldRecord fetched(const HeldRecord& record, std::string_view type);

/// The arrays as the contract sees them, valid while the record lives.
weft_record view_of(const HeldRecord& record);

/// The struct of a record, borrowing from it; nothing where the record is of another type.
template <class RecordType>
std::optional<RecordType> typed_in(const HeldRecord& record) {
  const HeldRecord here = fetched(record, RecordType::kType);
  if (here == nullptr) return std::nullopt;
  auto typed = read_record<RecordType>(view_of(here));
  if (!typed) return std::nullopt;
  return *std::move(typed);
}

}  // namespace weft::testing
