// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include <weft/testing/host_record.hpp>

namespace weft::testing {

/// Writes one record into a record file (npz). Throws std::runtime_error with the reason.
void write_record_file(const std::string& file, const char* slot, HostRecord record);

/// Writes a record struct into a record file.
template <class RecordType>
void write_record_file(const std::string& file, const char* slot, const RecordType& typed) {
  write_record_file(file, slot, hold(typed));
}

/// A record file, checked against the catalogue.
class RecordFile {
 public:
  /// Throws std::runtime_error with the reason.
  explicit RecordFile(const std::string& file);

  std::size_t count() const { return records_.size(); }

  /// The first record of this type, if there is one; it borrows from this object.
  template <class RecordType>
  std::optional<RecordType> get() const {
    for (const auto& [slot, record] : records_) {
      if (auto typed = typed_in<RecordType>(record)) return typed;
    }
    return std::nullopt;
  }

 private:
  std::vector<std::pair<std::string, HostRecord>> records_;
};

}  // namespace weft::testing
