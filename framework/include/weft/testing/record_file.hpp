// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>
#include <weft/testing/held_record.hpp>

namespace weft::testing {

/// Writes one record into a file of records (npz). Throws std::runtime_error with the reason.
void write_record_file(const std::string& file, const char* slot, HeldRecord record);

/// The same of a noun.
template <class Noun>
void write_record_file(const std::string& file, const char* slot, const Noun& noun) {
  write_record_file(file, slot, hold(noun));
}

/// A file of records, checked against the catalogue.
class RecordFile {
 public:
  /// Throws std::runtime_error with the reason.
  explicit RecordFile(const std::string& file);

  std::size_t count() const { return records_.size(); }

  /// The first record of this type, if there is one; it borrows from this.
  template <class Noun>
  std::optional<Noun> get() const {
    for (const auto& [slot, record] : records_) {
      if (auto noun = noun_in<Noun>(record)) return noun;
    }
    return std::nullopt;
  }

 private:
  std::vector<std::pair<std::string, HeldRecord>> records_;
};

}  // namespace weft::testing
